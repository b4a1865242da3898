//! What a device is and can do.

use ash::vk;
use serde::Serialize;

use super::error::GpuError;
use super::llvmpipe::can_compile_quickly;

/// The sort of a device.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceKind {
    /// A GPU with its own memory.
    Discrete,
    /// A GPU that shares the host's memory.
    Integrated,
    /// A part of a GPU in a virtual machine.
    Virtual,
    /// A driver that runs shaders on the CPU, such as lavapipe.
    Cpu,
    /// None of these.
    #[default]
    Other,
}

/// The name, driver and limits of a device.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct DeviceInfo {
    /// Its place in [`devices`](super::devices).
    pub index: usize,
    /// The driver's name for the device.
    pub name: String,
    /// The driver's name and version, such as "llvmpipe, Mesa 22.3.6 (LLVM 15.0.6)".
    pub driver: String,
    /// CPU, integrated, discrete, ...
    pub kind: DeviceKind,
    /// The Vulkan version of the device, such as "1.3.230".
    pub api_version: String,
    /// Largest SPIR-V version that the device accepts, as (major, minor).
    pub spirv_version: (u8, u8),
    /// PCI vendor.
    pub vendor_id: u32,
    /// PCI device.
    pub device_id: u32,
    /// Bytes of its largest device-local heap. Lavapipe before 24 reports a fixed 2 GiB.
    pub memory: u64,
    /// Bytes that one buffer may have.
    pub max_buffer_size: u64,
    /// Bytes that one storage binding may reach.
    pub max_storage_buffer_range: u64,
    /// Bytes that one uniform binding may reach.
    pub max_uniform_buffer_range: u64,
    /// Texels that one texel buffer may have.
    pub max_texels: u64,
    /// Texel buffers that a stage may bind; 0 where shaders may not have them with texels of two words.
    pub max_texel_buffers: u32,
    /// The offset of a texel buffer is a multiple of this, in bytes.
    pub texel_offset_alignment: u64,
    /// Storage buffers that a stage may bind.
    pub max_buffers: u32,
    /// Uniform buffers that a stage may bind.
    pub max_uniform_buffers: u32,
    /// The offset of a storage binding is a multiple of this, in bytes.
    pub storage_offset_alignment: u64,
    /// The offset of a uniform binding is a multiple of this, in bytes.
    pub uniform_offset_alignment: u64,
    /// Invocations of a workgroup along x.
    pub max_workgroup_size_x: u32,
    /// Invocations of a workgroup along x, y and z.
    pub max_workgroup_size: [u32; 3],
    /// Invocations of a workgroup in all.
    pub max_workgroup_invocations: u32,
    /// Workgroups of a dispatch along x.
    pub max_workgroups_x: u32,
    /// Workgroups of a dispatch along x, y and z.
    pub max_workgroups: [u32; 3],
    /// Bytes of workgroup memory.
    pub max_shared_memory: u32,
    /// Invocations of a subgroup.
    pub subgroup_size: u32,
    /// Subgroup operations in compute shaders: "basic", "vote", "arithmetic", "ballot", "shuffle".
    pub subgroup_operations: Vec<&'static str>,
    /// Whether shaders may use 64-bit integers.
    pub int64: bool,
    /// Whether shaders may use 64-bit floats.
    pub float64: bool,
    /// Whether the driver can leave out optimization and compiles a kernel in a fraction of the time then
    /// ([`compiles_quickly`](super::compiles_quickly)).
    pub can_compile_quickly: bool,
    /// Nanoseconds of a timestamp's step; 0 where the queue has none.
    pub timestamp_period: f32,
    /// Bits of a timestamp; 0 where the queue has none.
    pub timestamp_bits: u32,
}

impl DeviceInfo {
    /// Asks the driver. `None` for a device of Vulkan 1.0.
    pub(super) fn query(
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        queue_family: u32,
        index: usize,
    ) -> Result<Option<Self>, GpuError> {
        // SAFETY: `physical` comes from `instance`.
        let basic = unsafe { instance.get_physical_device_properties(physical) };
        if basic.api_version < vk::API_VERSION_1_1 {
            return Ok(None);
        }
        let extended = Extended::query(instance, physical, basic.api_version)?;
        // SAFETY: as above, for these three.
        let (families, memory, features) = unsafe {
            (
                instance.get_physical_device_queue_family_properties(physical),
                instance.get_physical_device_memory_properties(physical),
                instance.get_physical_device_features(physical),
            )
        };
        let bits = families
            .get(queue_family as usize)
            .map_or(0, |family| family.timestamp_valid_bits);
        let mut info = Self::from_properties(index, &basic, extended);
        info.memory = largest_local_heap(&memory);
        info.int64 = features.shader_int64 == vk::TRUE;
        info.float64 = features.shader_float64 == vk::TRUE;
        if features.shader_storage_image_extended_formats == vk::FALSE {
            info.max_texel_buffers = 0;
        }
        info.timestamp_bits = bits;
        Ok(Some(info))
    }

    fn from_properties(
        index: usize,
        basic: &vk::PhysicalDeviceProperties,
        extended: Extended,
    ) -> Self {
        let limits = &basic.limits;
        let name = basic.device_name_as_c_str().unwrap_or(c"unnamed device");
        Self {
            index,
            name: name.to_string_lossy().into_owned(),
            can_compile_quickly: can_compile_quickly(&extended.driver),
            driver: extended.driver,
            kind: kind(basic.device_type),
            api_version: version(basic.api_version),
            spirv_version: spirv_version(basic.api_version),
            vendor_id: basic.vendor_id,
            device_id: basic.device_id,
            memory: 0,
            max_buffer_size: extended.max_buffer_size,
            max_storage_buffer_range: u64::from(limits.max_storage_buffer_range),
            max_uniform_buffer_range: u64::from(limits.max_uniform_buffer_range),
            max_texels: u64::from(limits.max_texel_buffer_elements),
            max_texel_buffers: limits
                .max_per_stage_descriptor_storage_images
                .min(limits.max_descriptor_set_storage_images),
            texel_offset_alignment: limits.min_texel_buffer_offset_alignment.max(1),
            max_buffers: limits
                .max_per_stage_descriptor_storage_buffers
                .min(limits.max_descriptor_set_storage_buffers),
            max_uniform_buffers: limits
                .max_per_stage_descriptor_uniform_buffers
                .min(limits.max_descriptor_set_uniform_buffers),
            storage_offset_alignment: limits.min_storage_buffer_offset_alignment.max(1),
            uniform_offset_alignment: limits.min_uniform_buffer_offset_alignment.max(1),
            max_workgroup_size_x: limits.max_compute_work_group_size[0],
            max_workgroup_size: limits.max_compute_work_group_size,
            max_workgroup_invocations: limits.max_compute_work_group_invocations,
            max_workgroups_x: limits.max_compute_work_group_count[0],
            max_workgroups: limits.max_compute_work_group_count,
            max_shared_memory: limits.max_compute_shared_memory_size,
            subgroup_size: extended.subgroup_size,
            subgroup_operations: extended.subgroup_operations,
            int64: false,
            float64: false,
            timestamp_period: limits.timestamp_period,
            timestamp_bits: 0,
        }
    }
}

/// What the structs chained to the basic properties say.
struct Extended {
    driver: String,
    max_buffer_size: u64,
    subgroup_size: u32,
    subgroup_operations: Vec<&'static str>,
}

impl Extended {
    fn query(
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        api: u32,
    ) -> Result<Self, GpuError> {
        let has = |name| has_device_extension(instance, physical, name);
        let named = api >= vk::API_VERSION_1_2 || has(ash::khr::driver_properties::NAME)?;
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut subgroup = vk::PhysicalDeviceSubgroupProperties::default();
        let mut limits3 = vk::PhysicalDeviceMaintenance3Properties::default();
        let mut limits4 = vk::PhysicalDeviceMaintenance4Properties::default();
        let mut all = vk::PhysicalDeviceProperties2::default()
            .push_next(&mut subgroup)
            .push_next(&mut limits3);
        if named {
            all = all.push_next(&mut driver);
        }
        if api >= vk::API_VERSION_1_3 {
            all = all.push_next(&mut limits4);
        }
        // SAFETY: `physical` comes from `instance`, of Vulkan 1.1, and each chained struct is one that the device knows.
        unsafe { instance.get_physical_device_properties2(physical, &mut all) };
        let raw_version = all.properties.driver_version;
        let no_limit = |limit: u64| if limit == 0 { u64::MAX } else { limit };
        Ok(Self {
            driver: driver_text(named.then_some(&driver), raw_version),
            max_buffer_size: no_limit(limits3.max_memory_allocation_size)
                .min(no_limit(limits4.max_buffer_size)),
            subgroup_size: subgroup.subgroup_size,
            subgroup_operations: operations(&subgroup),
        })
    }
}

/// Whether a device has an extension.
pub(super) fn has_device_extension(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    name: &std::ffi::CStr,
) -> Result<bool, GpuError> {
    // SAFETY: `physical` comes from `instance`.
    let all = unsafe { instance.enumerate_device_extension_properties(physical) };
    let all = all.map_err(|e| GpuError::vulkan("list the device's extensions", e))?;
    Ok(all
        .iter()
        .any(|have| have.extension_name_as_c_str() == Ok(name)))
}

/// "llvmpipe, Mesa 22.3.6 (LLVM 15.0.6)", or the raw version where the driver has no name.
fn driver_text(named: Option<&vk::PhysicalDeviceDriverProperties<'_>>, raw_version: u32) -> String {
    let Some(driver) = named else {
        return format!("version {raw_version:#x}");
    };
    let text =
        |part: Option<&std::ffi::CStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    let name = text(driver.driver_name_as_c_str().ok());
    let info = text(driver.driver_info_as_c_str().ok());
    let parts: Vec<_> = [name, info]
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect();
    parts.join(", ")
}

fn kind(device: vk::PhysicalDeviceType) -> DeviceKind {
    match device {
        vk::PhysicalDeviceType::DISCRETE_GPU => DeviceKind::Discrete,
        vk::PhysicalDeviceType::INTEGRATED_GPU => DeviceKind::Integrated,
        vk::PhysicalDeviceType::VIRTUAL_GPU => DeviceKind::Virtual,
        vk::PhysicalDeviceType::CPU => DeviceKind::Cpu,
        _ => DeviceKind::Other,
    }
}

fn version(api: u32) -> String {
    let (major, minor) = (vk::api_version_major(api), vk::api_version_minor(api));
    format!("{major}.{minor}.{}", vk::api_version_patch(api))
}

/// Vulkan specification, appendix "Vulkan Environment for SPIR-V", versions.
fn spirv_version(api: u32) -> (u8, u8) {
    match api {
        api if api >= vk::API_VERSION_1_3 => (1, 6),
        api if api >= vk::API_VERSION_1_2 => (1, 5),
        _ => (1, 3),
    }
}

fn largest_local_heap(memory: &vk::PhysicalDeviceMemoryProperties) -> u64 {
    let local = memory.memory_heaps_as_slice().iter();
    let local = local.filter(|heap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL));
    local.map(|heap| heap.size).max().unwrap_or(0)
}

fn operations(subgroup: &vk::PhysicalDeviceSubgroupProperties<'_>) -> Vec<&'static str> {
    use vk::SubgroupFeatureFlags as Flag;
    if !subgroup
        .supported_stages
        .contains(vk::ShaderStageFlags::COMPUTE)
    {
        return Vec::new();
    }
    let all = [
        (Flag::BASIC, "basic"),
        (Flag::VOTE, "vote"),
        (Flag::ARITHMETIC, "arithmetic"),
        (Flag::BALLOT, "ballot"),
        (Flag::SHUFFLE, "shuffle"),
    ];
    let have = all
        .iter()
        .filter(|(flag, _)| subgroup.supported_operations.contains(*flag));
    have.map(|(_, name)| *name).collect()
}
