//! The Khronos validation layer's messages, recorded.

use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, PoisonError};

use ash::vk;

/// Messages kept in full; later ones are only counted.
const KEPT: usize = 256;

/// The warnings and errors of the validation layer. Clones share one log, which outlives the device.
#[derive(Debug, Clone, Default)]
pub struct ValidationLog(Arc<Mutex<Messages>>);

#[derive(Debug, Default)]
struct Messages {
    count: u64,
    kept: Vec<String>,
}

impl ValidationLog {
    /// The number of messages so far.
    pub fn count(&self) -> u64 {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).count
    }

    /// The text of the first 256 messages.
    pub fn messages(&self) -> Vec<String> {
        let messages = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        messages.kept.clone()
    }

    fn push(&self, text: String) {
        let mut messages = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        messages.count += 1;
        if messages.kept.len() < KEPT {
            messages.kept.push(text);
        }
    }

    /// A messenger that writes into this log, which must outlive the messenger.
    pub(super) fn messenger(&self) -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
        use vk::{
            DebugUtilsMessageSeverityFlagsEXT as Severity, DebugUtilsMessageTypeFlagsEXT as Type,
        };
        vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(Severity::WARNING | Severity::ERROR)
            .message_type(Type::VALIDATION | Type::PERFORMANCE)
            .pfn_user_callback(Some(record))
            .user_data(Arc::as_ptr(&self.0).cast_mut().cast())
    }
}

/// The callback of the messenger.
///
/// # Safety
/// Vulkan passes valid `data`, and `log` is the pointer that [`ValidationLog::messenger`] gave.
unsafe extern "system" fn record(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    log: *mut c_void,
) -> vk::Bool32 {
    let log: *const Mutex<Messages> = log.cast_const().cast();
    // SAFETY: `Instance` owns the log and drops it after the messenger, so it is alive; the count is
    // raised for the clone that `from_raw` takes over and drops.
    let log = unsafe {
        Arc::increment_strong_count(log);
        ValidationLog(Arc::from_raw(log))
    };
    // SAFETY: Vulkan passes null or a valid struct, whose message is null or a C string.
    let text = unsafe { data.as_ref() }.map(|data| data.p_message);
    let text = text.filter(|text| !text.is_null());
    let owned = |text| {
        // SAFETY: the message is not null, and a C string that lives during the callback.
        let text = unsafe { CStr::from_ptr(text) };
        text.to_string_lossy().into_owned()
    };
    log.push(text.map(owned).unwrap_or_default());
    vk::FALSE
}
