//! The Vulkan instance: the loader, the validation layer, and the devices to choose from.

use std::ffi::CStr;

use ash::{Entry, vk};

use super::error::GpuError;
use super::info::DeviceInfo;
use super::validation::ValidationLog;

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// Lists the usable devices: Vulkan 1.1 or later, with a compute queue. Their order is the driver's.
///
/// # Errors
/// [`GpuError::NoLoader`], [`GpuError::NoDriver`] or [`GpuError::NoDevice`], each with advice.
pub fn devices() -> Result<Vec<DeviceInfo>, GpuError> {
    let candidates = Instance::new(false)?.candidates()?;
    Ok(candidates.into_iter().map(|found| found.info).collect())
}

/// A physical device that can run compute shaders.
pub(super) struct Candidate {
    pub physical: vk::PhysicalDevice,
    pub queue_family: u32,
    pub info: DeviceInfo,
}

/// A Vulkan instance, destroyed on drop after its messenger.
pub(super) struct Instance {
    pub raw: ash::Instance,
    messenger: Option<(ash::ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    pub log: Option<ValidationLog>,
    // Dropped last: closes the loader's library, whose functions the fields above call.
    entry: Entry,
}

impl Instance {
    /// Opens the loader and creates an instance, with the validation layer if asked for.
    pub fn new(validation: bool) -> Result<Self, GpuError> {
        let entry = load_entry()?;
        let log = validation.then(ValidationLog::default);
        if validation {
            require_validation(&entry)?;
        }
        let raw = create(&entry, log.as_ref())?;
        let mut instance = Self {
            raw,
            messenger: None,
            log,
            entry,
        };
        instance.listen()?;
        Ok(instance)
    }

    /// Creates the messenger that fills the log.
    fn listen(&mut self) -> Result<(), GpuError> {
        let Some(log) = &self.log else { return Ok(()) };
        let functions = ash::ext::debug_utils::Instance::new(&self.entry, &self.raw);
        // SAFETY: the instance has VK_EXT_debug_utils, and the log outlives the messenger (see `drop`).
        let messenger = unsafe { functions.create_debug_utils_messenger(&log.messenger(), None) };
        let messenger = messenger.map_err(|e| GpuError::vulkan("create the debug messenger", e))?;
        self.messenger = Some((functions, messenger));
        Ok(())
    }

    /// Every usable device of the machine, in the driver's order; never an empty list.
    pub fn candidates(&self) -> Result<Vec<Candidate>, GpuError> {
        // SAFETY: the instance is alive.
        let all = match unsafe { self.raw.enumerate_physical_devices() } {
            Err(
                vk::Result::ERROR_INITIALIZATION_FAILED | vk::Result::ERROR_INCOMPATIBLE_DRIVER,
            ) => {
                return Err(GpuError::NoDriver);
            }
            other => other.map_err(|e| GpuError::vulkan("list the devices", e))?,
        };
        let mut found = Vec::new();
        for physical in all {
            if let Some(queue_family) = self.compute_family(physical) {
                let info = DeviceInfo::query(&self.raw, physical, queue_family, found.len())?;
                found.extend(info.map(|info| Candidate {
                    physical,
                    queue_family,
                    info,
                }));
            }
        }
        if found.is_empty() {
            return Err(GpuError::NoDevice);
        }
        Ok(found)
    }

    /// A queue family for compute; one without graphics is better, since long work there does not freeze a desktop.
    fn compute_family(&self, physical: vk::PhysicalDevice) -> Option<u32> {
        // SAFETY: `physical` comes from this instance.
        let families = unsafe {
            self.raw
                .get_physical_device_queue_family_properties(physical)
        };
        let compute = (0_u32..).zip(&families).filter(|(_, family)| {
            family.queue_count > 0 && family.queue_flags.contains(vk::QueueFlags::COMPUTE)
        });
        let graphics = |flags: vk::QueueFlags| flags.contains(vk::QueueFlags::GRAPHICS);
        let best = compute.min_by_key(|(_, family)| graphics(family.queue_flags));
        best.map(|(index, _)| index)
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: everything made from the instance holds it alive, so nothing is left; the log is dropped after.
        unsafe {
            if let Some((functions, messenger)) = self.messenger.take() {
                functions.destroy_debug_utils_messenger(messenger, None);
            }
            self.raw.destroy_instance(None);
        }
    }
}

/// Opens the loader's library and makes sure that it knows Vulkan 1.1.
fn load_entry() -> Result<Entry, GpuError> {
    // SAFETY: the loader's library has no other initialisation than that of its own constructors.
    let entry = unsafe { Entry::load() }.map_err(|error| GpuError::NoLoader {
        reason: error.to_string(),
    })?;
    // SAFETY: the function pointer was just loaded.
    let version = unsafe { entry.try_enumerate_instance_version() };
    let version = version.map_err(|e| GpuError::vulkan("ask for the loader's version", e))?;
    match version {
        Some(version) if version >= vk::API_VERSION_1_1 => Ok(entry),
        _ => Err(GpuError::OldLoader),
    }
}

/// Fails when the validation layer or its message extension is missing.
fn require_validation(entry: &Entry) -> Result<(), GpuError> {
    // SAFETY: the loader is open.
    let layers = unsafe { entry.enumerate_instance_layer_properties() };
    let layers = layers.map_err(|e| GpuError::vulkan("list the layers", e))?;
    let named = |layer: &vk::LayerProperties| layer.layer_name_as_c_str() == Ok(VALIDATION_LAYER);
    if !layers.iter().any(named) {
        let missing = "VK_LAYER_KHRONOS_validation";
        return Err(GpuError::NoValidation { missing });
    }
    if !has_layer_extension(entry, ash::ext::debug_utils::NAME)? {
        let missing = "VK_EXT_debug_utils";
        return Err(GpuError::NoValidation { missing });
    }
    Ok(())
}

fn has_layer_extension(entry: &Entry, name: &CStr) -> Result<bool, GpuError> {
    // SAFETY: the loader is open, and the layer's name is a C string of a layer that it listed.
    let all = unsafe { entry.enumerate_instance_extension_properties(Some(VALIDATION_LAYER)) };
    let all = all.map_err(|e| GpuError::vulkan("list the instance extensions", e))?;
    Ok(all
        .iter()
        .any(|have| have.extension_name_as_c_str() == Ok(name)))
}

/// Creates the instance: validation when there is a log, and drivers such as MoltenVK included where the loader
/// knows how. Asking it beforehand would make it load every driver of the machine twice.
fn create(entry: &Entry, log: Option<&ValidationLog>) -> Result<ash::Instance, GpuError> {
    let made = match try_create(entry, log, true)? {
        Err(vk::Result::ERROR_EXTENSION_NOT_PRESENT) => try_create(entry, log, false)?,
        other => other,
    };
    match made {
        Err(vk::Result::ERROR_INCOMPATIBLE_DRIVER) => Err(GpuError::NoDriver),
        other => other.map_err(|e| GpuError::vulkan("create an instance", e)),
    }
}

fn try_create(
    entry: &Entry,
    log: Option<&ValidationLog>,
    portability: bool,
) -> Result<Result<ash::Instance, vk::Result>, GpuError> {
    let application = vk::ApplicationInfo::default()
        .application_name(c"etendue")
        .api_version(vk::API_VERSION_1_3);
    let (mut extensions, mut layers) = (Vec::new(), Vec::new());
    let mut info = vk::InstanceCreateInfo::default().application_info(&application);
    if portability {
        extensions.push(ash::khr::portability_enumeration::NAME.as_ptr());
        info = info.flags(vk::InstanceCreateFlags::ENUMERATE_PORTABILITY_KHR);
    }
    let mut messenger = log.map(ValidationLog::messenger).unwrap_or_default();
    let mut features = vk::ValidationFeaturesEXT::default()
        .enabled_validation_features(&[vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION]);
    if log.is_some() {
        extensions.push(ash::ext::debug_utils::NAME.as_ptr());
        layers.push(VALIDATION_LAYER.as_ptr());
        info = info.push_next(&mut messenger);
        if has_layer_extension(entry, ash::ext::validation_features::NAME)? {
            extensions.push(ash::ext::validation_features::NAME.as_ptr());
            info = info.push_next(&mut features);
        }
    }
    let info = info
        .enabled_extension_names(&extensions)
        .enabled_layer_names(&layers);
    // SAFETY: `info` points to the locals above, which live until the call returns.
    Ok(unsafe { entry.create_instance(&info, None) })
}
