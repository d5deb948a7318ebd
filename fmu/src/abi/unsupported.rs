//! Functions of FMI 3.0 that these models have no use for. The capabilities in modelDescription.xml say so; whoever calls one gets
//! `fmi3Error`, and its name to the logger.

use std::ffi::{c_char, c_void};

use super::registry::{Handle, Logger, Status, call, enter};
use super::{IntermediateUpdate, LogMessage};

macro_rules! unsupported {
    ($($name:ident($($type:ty),*);)*) => {$(
        /// Not supported.
        #[unsafe(no_mangle)]
        pub extern "C" fn $name(instance: Handle, $(_: $type),*) -> Status {
            call(instance, |_| anyhow::bail!("{} is not supported", stringify!($name)))
        }
    )*};
}

/// Variables of a type that no model has: none of them is done without complaint.
macro_rules! no_such_type {
    ($($get:ident $set:ident $type:ty;)*) => { unsupported! {$(
        $get(*const u32, usize, *mut $type, usize);
        $set(*const u32, usize, *const $type, usize);
    )*} };
}

no_such_type! {
    fmi3GetFloat32 fmi3SetFloat32 f32;
    fmi3GetInt8 fmi3SetInt8 i8;
    fmi3GetUInt8 fmi3SetUInt8 u8;
    fmi3GetInt16 fmi3SetInt16 i16;
    fmi3GetUInt16 fmi3SetUInt16 u16;
    fmi3GetUInt32 fmi3SetUInt32 u32;
    fmi3GetInt64 fmi3SetInt64 i64;
    fmi3GetUInt64 fmi3SetUInt64 u64;
}

unsupported! {
    fmi3GetBinary(*const u32, usize, *mut usize, *mut *const u8, usize);
    fmi3SetBinary(*const u32, usize, *const usize, *const *const u8, usize);
    fmi3GetClock(*const u32, usize, *mut bool);
    fmi3SetClock(*const u32, usize, *const bool);
    fmi3GetNumberOfVariableDependencies(u32, *mut usize);
    fmi3GetVariableDependencies(u32, *mut usize, *mut u32, *mut usize, *mut i32, usize);
    fmi3GetFMUState(*mut *mut c_void);
    fmi3SetFMUState(*mut c_void);
    fmi3FreeFMUState(*mut *mut c_void);
    fmi3SerializedFMUStateSize(*mut c_void, *mut usize);
    fmi3SerializeFMUState(*mut c_void, *mut u8, usize);
    fmi3DeserializeFMUState(*const u8, usize, *mut *mut c_void);
    fmi3GetDirectionalDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize);
    fmi3GetAdjointDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize);
    fmi3EnterConfigurationMode();
    fmi3ExitConfigurationMode();
    fmi3GetIntervalDecimal(*const u32, usize, *mut f64, *mut i32);
    fmi3GetIntervalFraction(*const u32, usize, *mut u64, *mut u64, *mut i32);
    fmi3GetShiftDecimal(*const u32, usize, *mut f64);
    fmi3GetShiftFraction(*const u32, usize, *mut u64, *mut u64);
    fmi3SetIntervalDecimal(*const u32, usize, *const f64);
    fmi3SetIntervalFraction(*const u32, usize, *const u64, *const u64);
    fmi3SetShiftDecimal(*const u32, usize, *const f64);
    fmi3SetShiftFraction(*const u32, usize, *const u64, *const u64);
    fmi3EnterEventMode();
    fmi3EvaluateDiscreteStates();
    fmi3UpdateDiscreteStates(*mut bool, *mut bool, *mut bool, *mut bool, *mut bool, *mut f64);
    fmi3EnterContinuousTimeMode();
    fmi3CompletedIntegratorStep(bool, *mut bool, *mut bool);
    fmi3SetTime(f64);
    fmi3SetContinuousStates(*const f64, usize);
    fmi3GetContinuousStateDerivatives(*mut f64, usize);
    fmi3GetEventIndicators(*mut f64, usize);
    fmi3GetContinuousStates(*mut f64, usize);
    fmi3GetNominalsOfContinuousStates(*mut f64, usize);
    fmi3GetNumberOfEventIndicators(*mut usize);
    fmi3GetNumberOfContinuousStates(*mut usize);
    fmi3EnterStepMode();
    fmi3GetOutputDerivatives(*const u32, usize, *const i32, *mut f64, usize);
    fmi3ActivateModelPartition(u32, f64);
}

/// Not supported: null, and why to the logger.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    logging: bool,
    environment: *mut c_void,
    log_message: LogMessage,
) -> Handle {
    enter(Logger::new(environment, log_message, logging), || {
        anyhow::bail!("model exchange is asked for, expected co-simulation")
    })
}

/// Not supported: null, and why to the logger.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateScheduledExecution(
    _name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    logging: bool,
    environment: *mut c_void,
    log_message: LogMessage,
    _clock_update: IntermediateUpdate,
    _lock_preemption: IntermediateUpdate,
    _unlock_preemption: IntermediateUpdate,
) -> Handle {
    enter(Logger::new(environment, log_message, logging), || {
        anyhow::bail!("scheduled execution is asked for, expected co-simulation")
    })
}
