//! The functions of FMI 3.0, as C calls them: the only place with unsafe code.
//!
//! An `fmi3Instance` is a number and points to nothing: a stale, freed or invented one is found out. What an importer's pointers
//! point to cannot be checked, only that they are not null; by FMI they hold as many elements as the count beside them says. A
//! panic ends here, as `fmi3Fatal`.
#![allow(unsafe_code, non_snake_case)]

mod registry;
mod unsupported;

use std::ffi::{CStr, c_char, c_void};

use anyhow::{Context, bail, ensure};

use crate::instance::Instance;
use crate::model::Model;
use crate::variable::Value;
pub use registry::{Handle, Status};
use registry::{Logger, call, enter, leave};
pub use unsupported::*;

/// `fmi3LogMessageCallback`: environment, status, category, message.
pub type LogMessage =
    Option<unsafe extern "C" fn(*mut c_void, Status, category: *const c_char, message: *const c_char)>;
/// `fmi3IntermediateUpdateCallback`, which is never called.
pub type IntermediateUpdate = Option<unsafe extern "C" fn()>;

/// The elements that a pointer of an importer points to.
///
/// # Safety
/// If it is not null, it points to as many elements, which nobody changes meanwhile.
unsafe fn given<'a, T>(pointer: *const T, count: usize) -> anyhow::Result<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    ensure!(!pointer.is_null(), "a null pointer, expected {count} elements");
    // SAFETY: not null, and the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Writes to where a pointer of an importer points, or nowhere if it is null.
///
/// # Safety
/// If it is not null, an element may be written there.
unsafe fn put<T>(pointer: *mut T, value: T) {
    if !pointer.is_null() {
        // SAFETY: not null, and the caller's promise.
        unsafe { pointer.write(value) }
    }
}

/// A text of an importer.
///
/// # Safety
/// If it is not null, it points to a text that ends with a zero.
unsafe fn text(pointer: *const c_char) -> anyhow::Result<String> {
    ensure!(!pointer.is_null(), "a null pointer, expected a text");
    // SAFETY: not null, and the caller's promise.
    let text = unsafe { CStr::from_ptr(pointer) };
    Ok(text.to_str().context("a text that is no UTF-8")?.to_owned())
}

fn same_count(references: usize, values: usize) -> anyhow::Result<()> {
    ensure!(references == values, "{values} values for {references} value references, expected one each");
    Ok(())
}

/// The version of FMI.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Makes an instance; null if that cannot be, and why to the logger.
///
/// # Safety
/// The texts end with a zero, and the logger takes what FMI says it does.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    logging: bool,
    event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    log_message: LogMessage,
    _intermediate_update: IntermediateUpdate,
) -> Handle {
    enter(Logger::new(environment, log_message, logging), || {
        ensure!(!event_mode, "the event mode is asked for, expected a co-simulation without it");
        // SAFETY: the caller's promise.
        let token = unsafe { text(token) }.context("instantiation token")?;
        Ok(Instance::new(Model::of_token(&token)?))
    })
}

/// Ends an instance; null is nothing.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3FreeInstance(instance: Handle) {
    leave(instance);
}

/// Says whether refused commands and held inputs are told to the logger; errors always are.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetDebugLogging(
    instance: Handle,
    on: bool,
    _count: usize,
    _categories: *const *const c_char,
) -> Status {
    registry::set_logging(instance, on)
}

/// Begins the initialization.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3EnterInitializationMode(
    instance: Handle,
    _tolerance_defined: bool,
    _tolerance: f64,
    start: f64,
    _stop_defined: bool,
    _stop: f64,
) -> Status {
    call(instance, |instance| instance.enter_initialization(start).map(|()| Vec::new()))
}

/// Ends the initialization.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3ExitInitializationMode(instance: Handle) -> Status {
    call(instance, |instance| instance.exit_initialization().map(|()| Vec::new()))
}

/// Ends the simulation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Terminate(instance: Handle) -> Status {
    call(instance, |instance| instance.terminate().map(|()| Vec::new()))
}

/// Makes an instance as new.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Reset(instance: Handle) -> Status {
    call(instance, |instance| {
        instance.reset();
        Ok(Vec::new())
    })
}

/// Takes a step.
///
/// # Safety
/// Each pointer is null, or an element may be written there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: Handle,
    from: f64,
    length: f64,
    _no_set_state_before: bool,
    event_handling_needed: *mut bool,
    terminate_simulation: *mut bool,
    early_return: *mut bool,
    last_successful_time: *mut f64,
) -> Status {
    call(instance, |instance| {
        let done = instance.step(from, length);
        // SAFETY: the caller's promise.
        unsafe {
            put(event_handling_needed, false);
            put(terminate_simulation, false);
            put(early_return, false);
            put(last_successful_time, instance.now());
        }
        done
    })
}

macro_rules! numbers {
    ($($get:ident $set:ident $type:ty, $raw:ty, $value:ident, $read:expr;)*) => {$(
        /// Reads variables.
        ///
        /// # Safety
        /// Each pointer is null, or points to as many elements as its count says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            instance: Handle,
            references: *const u32,
            count: usize,
            values: *mut $type,
            value_count: usize,
        ) -> Status {
            call(instance, |instance| {
                same_count(count, value_count)?;
                ensure!(count == 0 || !values.is_null(), "a null pointer, expected {count} elements");
                // SAFETY: the caller's promise.
                for (i, &reference) in unsafe { given(references, count) }?.iter().enumerate() {
                    let name = instance.name(reference)?;
                    let value = match instance.get(reference)? {
                        Value::$value(value) => value,
                        other => bail!("{name} is read by {}, expected fmi3Get{}", stringify!($get), other.type_name()),
                    };
                    // SAFETY: not null, and the caller's promise; `i` is below the count.
                    unsafe { values.add(i).write(*value) };
                }
                Ok(Vec::new())
            })
        }

        /// Sets variables.
        ///
        /// # Safety
        /// Each pointer is null, or points to as many elements as its count says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            instance: Handle,
            references: *const u32,
            count: usize,
            values: *const $type,
            value_count: usize,
        ) -> Status {
            call(instance, |instance| {
                same_count(count, value_count)?;
                // SAFETY: the caller's promise.
                let (references, values) =
                    unsafe { (given(references, count)?, given(values.cast::<$raw>(), count)?) };
                let mut told = Vec::new();
                for (&reference, &value) in references.iter().zip(values) {
                    told.extend(instance.set(reference, Value::$value($read(value)))?);
                }
                Ok(told)
            })
        }
    )*};
}

// A flag of C may have any bits.
numbers! {
    fmi3GetFloat64 fmi3SetFloat64 f64, f64, Real, |x| x;
    fmi3GetInt32 fmi3SetInt32 i32, i32, Whole, |x| x;
    fmi3GetBoolean fmi3SetBoolean bool, u8, Flag, |x| x != 0;
}

/// Reads texts, which stay until the next call to this instance.
///
/// # Safety
/// Each pointer is null, or points to as many elements as its count says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetString(
    instance: Handle,
    references: *const u32,
    count: usize,
    values: *mut *const c_char,
    value_count: usize,
) -> Status {
    call(instance, |instance| {
        same_count(count, value_count)?;
        ensure!(count == 0 || !values.is_null(), "a null pointer, expected {count} elements");
        // SAFETY: the caller's promise.
        let references = unsafe { given(references, count) }?;
        for (i, text) in instance.texts(references)?.iter().enumerate() {
            // SAFETY: not null, and the caller's promise; `i` is below the count.
            unsafe { values.add(i).write(text.as_ptr()) };
        }
        Ok(Vec::new())
    })
}

/// Sets texts.
///
/// # Safety
/// Each pointer is null, or points to as many elements as its count says; texts end with a zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetString(
    instance: Handle,
    references: *const u32,
    count: usize,
    values: *const *const c_char,
    value_count: usize,
) -> Status {
    call(instance, |instance| {
        same_count(count, value_count)?;
        // SAFETY: the caller's promise.
        let (references, values) = unsafe { (given(references, count)?, given(values, count)?) };
        for (&reference, &value) in references.iter().zip(values) {
            // SAFETY: the caller's promise.
            let value = unsafe { text(value) }.with_context(|| format!("value reference {reference}"))?;
            instance.set(reference, Value::Text(value))?;
        }
        Ok(Vec::new())
    })
}
