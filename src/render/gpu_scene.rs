//! A prepared scene on a device.

use super::error::RenderError;
use super::layout::Light;
use super::paged::{Page, PagedBuffer};
use super::prepared::Prepared;
use super::program::device_elements;
use super::reading::{FIRST_PAGED_BINDING, Reading};
use super::short_tables::short_tables;
use super::textures::srgb_table;
use crate::gpu::{Bound, Buffer, Device, GpuError, Loads};

/// The buffers of a scene.
pub struct GpuScene {
    /// Fixed buffers by binding number.
    fixed: Vec<(u32, Buffer)>,
    /// Large arrays, in the order of their bindings.
    paged: Vec<PagedBuffer>,
    /// Whether the acceleration structure is a list, which all lanes read at one place.
    is_list: bool,
    /// Names of tables of a few entries.
    short_tables: Vec<&'static str>,
}

impl GpuScene {
    /// Uploads everything.
    ///
    /// # Errors
    /// The device's memory or number of bindings does not suffice.
    pub fn upload(device: &Device, scene: &Prepared) -> Result<Self, RenderError> {
        let paged = paged_buffers(device, scene)?;
        let of_storage = |buffer: &PagedBuffer| buffer.pages(Loads::default()).len();
        let pages: usize = paged.iter().map(of_storage).sum();
        let limit = device
            .info()
            .max_buffers
            .saturating_sub(FIRST_PAGED_BINDING);
        if pages as u64 > u64::from(limit) {
            return Err(RenderError::TooMany {
                what: "pages of device buffers",
                count: pages as u64,
                limit: u64::from(limit),
            });
        }
        Ok(Self {
            fixed: fixed_buffers(device, scene)?,
            paged,
            is_list: scene.bvh.is_list(),
            short_tables: short_tables(scene),
        })
    }

    /// Every buffer with its binding number, for a kernel that reads so.
    pub fn bindings(&self, loads: Loads) -> Vec<Bound<'_>> {
        let fixed = self.fixed.iter();
        let fixed = fixed.map(|(binding, buffer)| (*binding, buffer, None));
        let pages = self
            .arrays(loads)
            .flat_map(|(array, loads)| array.pages(loads));
        let pages = pages.chain(self.uniform_page(loads));
        let paged = (FIRST_PAGED_BINDING..).zip(pages);
        fixed
            .chain(paged.map(|(binding, (buffer, range))| (binding, buffer, range)))
            .collect()
    }

    /// The large arrays, and how each is read.
    fn arrays(&self, loads: Loads) -> impl Iterator<Item = (&PagedBuffer, Loads)> {
        let others = std::iter::repeat(loads);
        let all = std::iter::once(self.of_elements(loads)).chain(others);
        self.paged.iter().zip(all)
    }

    /// How the elements are read: all lanes read a list at one place.
    fn of_elements(&self, loads: Loads) -> Loads {
        match self.is_list {
            true => loads.without_texels(),
            false => loads,
        }
    }

    /// The elements once more, where they are read as texels and one page of a storage buffer holds all
    /// ([`Reading::uniform_elements`]).
    fn uniform_page(&self, loads: Loads) -> Option<Page<'_>> {
        let pages = self.paged.first()?.pages(loads.without_texels());
        let is_one = self.of_elements(loads).texels && pages.len() == 1;
        pages.first().copied().filter(|_| is_one)
    }

    /// The generated `buffers.wgsl`.
    pub fn buffers_wgsl(&self, reading: Reading<'_>) -> String {
        let mut binding = FIRST_PAGED_BINDING;
        let mut text = String::from(
            "// Generated: the film, and large arrays, split over pages where the device asks for it.\n",
        ) + &reading.film()
            + &reading.tables(&self.short_tables);
        for (array, loads) in self.arrays(reading.loads) {
            text += &array.wgsl(binding, Reading { loads, ..reading });
            binding += array.pages(loads).len() as u32;
        }
        let uniform = self.uniform_page(reading.loads).map(|_| binding);
        text + &reading.uniform_elements(uniform)
    }

    /// Bytes of all data.
    pub fn bytes(&self) -> u64 {
        let fixed: u64 = self.fixed.iter().map(|(_, b)| b.bytes()).sum();
        fixed + self.paged.iter().map(PagedBuffer::bytes).sum::<u64>()
    }
}

fn fixed_buffers(device: &Device, scene: &Prepared) -> Result<Vec<(u32, Buffer)>, GpuError> {
    // A kernel with lights that the scene has not may look at the first.
    let lights = match scene.lights.table.is_empty() {
        true => device.buffer_with("lights", &[Light::default()])?,
        false => device.buffer_with("lights", &scene.lights.table)?,
    };
    Ok(vec![
        (4, device.buffer_with("materials", &scene.materials)?),
        (5, device.buffer_with("textures", &scene.textures.textures)?),
        (6, lights),
        (7, device.buffer_with("punctual lights", &scene.punctual)?),
        (8, device.buffer_with("sRGB table", &srgb_table())?),
        (
            10,
            device.buffer_with("BSDF tables", &scene.bsdf_tables.values)?,
        ),
    ])
}

fn paged_buffers(device: &Device, scene: &Prepared) -> Result<Vec<PagedBuffer>, GpuError> {
    let environment = &scene.environment;
    let indices = scene.indices.as_flattened();
    // Indices are read only to find a vertex's attributes.
    let indices = if scene.vertex_format.stride == 0 {
        &[]
    } else {
        indices
    };
    // In the order of LARGE_ARRAYS.
    let words = PagedBuffer::upload::<u32>;
    Ok(vec![
        PagedBuffer::upload(device, 0, &device_elements(&scene.bvh))?,
        words(device, 1, indices)?,
        PagedBuffer::upload(device, 2, scene.vertex_words.as_chunks::<2>().0)?,
        words(device, 3, &scene.textures.words)?,
        PagedBuffer::upload(device, 4, &environment.texels)?,
        words(device, 5, &environment.cdf)?,
        PagedBuffer::upload(device, 6, scene.lights.nodes())?,
    ])
}
