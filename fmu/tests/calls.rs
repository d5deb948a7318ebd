//! The functions as an importer calls them: what is refused, and with which words.
#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::{null, null_mut, without_provenance_mut};
use std::sync::Mutex;

use pt326_fmu::abi::*;
use pt326_fmu::model::{Model, TERMINALS, models};
use pt326_fmu::{description, instrument, rig};

/// What an instance has told.
type Told = Mutex<Vec<(Status, String)>>;

unsafe extern "C" fn log(told: *mut c_void, status: Status, category: *const c_char, message: *const c_char) {
    // SAFETY: `Part` gave a pointer to its own list, and the library gives texts.
    let (told, category, message) =
        unsafe { (&*told.cast::<Told>(), CStr::from_ptr(category), CStr::from_ptr(message)) };
    assert!(category.to_str().unwrap().starts_with("logStatus"));
    told.lock().unwrap().push((status, message.to_str().unwrap().to_owned()));
}

/// An instance, and what it has told.
struct Part {
    handle: Handle,
    model: &'static Model,
    told: Box<Told>,
}

impl Part {
    fn with_token(model: &'static Model, token: *const c_char, event_mode: bool) -> Self {
        let told = Box::new(Told::default());
        let environment = (&raw const *told).cast_mut().cast();
        // SAFETY: texts and a logger as FMI asks for them; the list lives as long as the instance.
        let handle = unsafe {
            let name = c"part".as_ptr();
            fmi3InstantiateCoSimulation(
                name,
                token,
                null(),
                false,
                true,
                event_mode,
                false,
                null(),
                0,
                environment,
                Some(log),
                None,
            )
        };
        Self { handle, model, told }
    }

    fn new(model: &'static Model) -> Self {
        let token = CString::new(model.token()).unwrap();
        Self::with_token(model, token.as_ptr(), false)
    }

    fn begun(model: &'static Model) -> Self {
        let part = Self::new(model);
        assert_eq!(part.initialize(), Status::Ok);
        assert_eq!(fmi3ExitInitializationMode(part.handle), Status::Ok);
        part
    }

    fn initialize(&self) -> Status {
        fmi3EnterInitializationMode(self.handle, false, 0.0, 0.0, false, 0.0)
    }

    fn reference(&self, name: &str) -> u32 {
        self.model.variables.iter().position(|variable| variable.name == name).unwrap() as u32
    }

    fn set_real(&self, name: &str, value: f64) -> Status {
        // SAFETY: one element each.
        unsafe { fmi3SetFloat64(self.handle, &self.reference(name), 1, &value, 1) }
    }

    fn set_flag(&self, name: &str, value: bool) -> Status {
        // SAFETY: one element each.
        unsafe { fmi3SetBoolean(self.handle, &self.reference(name), 1, &value, 1) }
    }

    fn set_text(&self, name: &str, value: &str) -> Status {
        let value = CString::new(value).unwrap();
        // SAFETY: one element each, and a text.
        unsafe { fmi3SetString(self.handle, &self.reference(name), 1, &value.as_ptr(), 1) }
    }

    fn real(&self, name: &str) -> (Status, f64) {
        let mut value = f64::NAN;
        // SAFETY: one element each.
        let status = unsafe { fmi3GetFloat64(self.handle, &self.reference(name), 1, &mut value, 1) };
        (status, value)
    }

    fn text(&self, name: &str) -> String {
        let mut value = null();
        // SAFETY: one element each; the text is read before the next call.
        unsafe {
            assert_eq!(fmi3GetString(self.handle, &self.reference(name), 1, &mut value, 1), Status::Ok);
            CStr::from_ptr(value).to_str().unwrap().to_owned()
        }
    }

    fn step(&self, from: f64, length: f64) -> Status {
        // SAFETY: no pointer to write to.
        unsafe { fmi3DoStep(self.handle, from, length, true, null_mut(), null_mut(), null_mut(), null_mut()) }
    }

    /// The status, and words that are told with it.
    #[track_caller]
    fn tells(&self, is: Status, expected: Status, words: &[&str]) {
        let told = self.told.lock().unwrap().pop();
        assert!(is == expected, "{is:?}, {told:?}");
        let (status, message) = told.expect("something is told");
        assert_eq!(status, expected, "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        fmi3FreeInstance(self.handle);
    }
}

#[test]
fn an_instance_is_made_by_its_token_only() {
    for (token, event_mode, words) in [
        (null(), false, ["instantiation token", "null pointer"]),
        (c"{1234}".as_ptr(), false, ["{1234}", "expected pt326_rig-"]),
        (c"".as_ptr(), true, ["event mode", "without it"]),
    ] {
        let part = Part::with_token(&rig::MODEL, token, event_mode);
        assert!(part.handle.is_null());
        part.tells(Status::Error, Status::Error, &words);
    }
    assert!(fmi3InstantiateModelExchange(null(), null(), null(), false, false, null_mut(), None).is_null());
}

#[test]
fn null_freed_and_invented_instances_are_found_out() {
    let freed = Part::begun(&rig::MODEL).handle;
    for handle in [null_mut(), freed, without_provenance_mut(usize::MAX)] {
        assert_eq!(fmi3Reset(handle), Status::Error);
        assert_eq!(fmi3SetDebugLogging(handle, true, 0, null()), Status::Error);
        fmi3FreeInstance(handle);
    }
}

#[test]
fn null_pointers_and_counts_that_differ_are_refused() {
    let part = Part::begun(&rig::MODEL);
    let (power, fault, mut value) = (part.reference("power"), part.reference("fault1.kind"), 0.0);
    // SAFETY: null, or one element each.
    unsafe {
        let words = ["null pointer", "1 elements"];
        part.tells(fmi3GetFloat64(part.handle, null(), 1, &mut value, 1), Status::Error, &words);
        part.tells(fmi3GetFloat64(part.handle, &power, 1, null_mut(), 1), Status::Error, &words);
        part.tells(fmi3SetFloat64(part.handle, &power, 1, null(), 1), Status::Error, &words);
        part.tells(fmi3GetString(part.handle, &fault, 1, null_mut(), 1), Status::Error, &words);
        part.tells(fmi3SetString(part.handle, &fault, 1, &null(), 1), Status::Error, &["null", "a text"]);
        let differ = fmi3GetFloat64(part.handle, &power, 1, &mut value, 0);
        part.tells(differ, Status::Error, &["0 values for 1 value references"]);
        assert_eq!(fmi3GetFloat64(part.handle, null(), 0, null_mut(), 0), Status::Ok);
    }
}

#[test]
fn a_variable_that_is_none_or_of_another_type_is_named() {
    let part = Part::begun(&rig::MODEL);
    let (unknown, power, truth) = (1000, part.reference("power"), part.reference("truth"));
    let (mut number, mut whole) = (0.0, 0);
    // SAFETY: one element each.
    unsafe {
        let get = |reference, value| fmi3GetFloat64(part.handle, &reference, 1, value, 1);
        part.tells(get(unknown, &mut number), Status::Error, &["value reference 1000", "0 to "]);
        part.tells(get(truth, &mut number), Status::Error, &["truth", "fmi3GetFloat64", "fmi3GetInt32"]);
        let set = fmi3SetInt32(part.handle, &power, 1, &7, 1);
        part.tells(set, Status::Error, &["power is set as Int32", "Float64"]);
        assert_eq!(fmi3GetInt32(part.handle, &truth, 1, &mut whole, 1), Status::Ok);
        let set = fmi3SetInt32(part.handle, &truth, 1, &7, 1);
        part.tells(set, Status::Error, &["truth is set", "Output"]);
    }
    part.tells(fmi3EnterStepMode(part.handle), Status::Error, &["fmi3EnterStepMode is not supported"]);
}

#[test]
fn inputs_are_held_to_their_bounds_and_parameters_refused_beyond_them() {
    let part = Part::new(&rig::MODEL);
    part.tells(part.set_real("sample_time", 10.5), Status::Error, &["sample_time is 10.5", "0 to 10 s"]);
    assert_eq!((part.initialize(), fmi3ExitInitializationMode(part.handle)), (Status::Ok, Status::Ok));
    for (given, held) in [(-1.0, 0.0), (100.000_000_1, 100.0), (f64::INFINITY, 100.0)] {
        let expected = ["power is", "expected 0 to 100 %", &format!("held to {held}")];
        part.tells(part.set_real("power", given), Status::Warning, &expected);
        assert_eq!(part.real("power"), (Status::Ok, held));
    }
    part.tells(part.set_real("power", f64::NAN), Status::Error, &["power is NaN", "0 to 100 %"]);
    assert_eq!((part.set_real("power", 100.0), part.real("power")), (Status::Ok, (Status::Ok, 100.0)));
}

#[test]
fn each_call_has_its_time() {
    let part = Part::new(&rig::MODEL);
    part.tells(part.step(0.0, 0.11), Status::Error, &["fmi3DoStep", "Instantiated", "StepMode"]);
    part.tells(fmi3ExitInitializationMode(part.handle), Status::Error, &["Instantiated"]);
    let late = fmi3EnterInitializationMode(part.handle, false, 0.0, f64::NAN, false, 0.0);
    part.tells(late, Status::Error, &["start time is NaN"]);
    assert_eq!(part.initialize(), Status::Ok);
    part.tells(part.initialize(), Status::Error, &["InitializationMode"]);
    assert_eq!(fmi3ExitInitializationMode(part.handle), Status::Ok);
    part.tells(part.set_text("preset", "trainer"), Status::Error, &["preset is set", "StepMode"]);
    assert_eq!(part.step(0.0, 0.11), Status::Ok);
    assert_eq!(fmi3Terminate(part.handle), Status::Ok);
    part.tells(part.step(0.11, 0.11), Status::Error, &["Terminated"]);
    assert_eq!(part.real("time"), (Status::Ok, 0.11));
    assert_eq!(fmi3Reset(part.handle), Status::Ok);
    assert_eq!(part.set_text("preset", "trainer"), Status::Ok);
}

#[test]
fn a_step_is_whole_sample_times_and_begins_where_the_last_ended() {
    let part = Part::begun(&rig::MODEL);
    for length in [0.0, 0.1, 0.165, 0.2201, -0.11, f64::NAN, f64::INFINITY] {
        part.tells(
            part.step(0.0, length),
            Status::Error,
            &["step is", "sample time, 0.11 s, or a whole multiple"],
        );
    }
    assert_eq!(part.step(0.0, 0.11 + 1e-12), Status::Ok);
    part.tells(part.step(0.0, 0.11), Status::Error, &["begins at 0 s", "0.11"]);
    let mut reached = f64::NAN;
    // SAFETY: one element.
    let status =
        unsafe { fmi3DoStep(part.handle, 0.5, 0.11, true, null_mut(), null_mut(), null_mut(), &mut reached) };
    part.tells(status, Status::Error, &["begins at 0.5 s"]);
    assert_eq!(reached, 0.11 + 1e-12);
    assert_eq!((part.step(0.11, 0.11), part.real("time").1), (Status::Ok, 0.22));
}

#[test]
fn a_long_step_is_as_many_short_ones() {
    let [long, short] = [4, 1].map(|ticks| {
        let part = Part::begun(&rig::MODEL);
        part.set_real("power", 60.0);
        let length = f64::from(ticks) * 0.11;
        for step in 0..100 / ticks {
            assert_eq!(part.step(f64::from(step) * length, length), Status::Ok);
        }
        ["code_t0", "code_t1", "code_t2", "air_t1"].map(|name| part.real(name).1)
    });
    assert_eq!(long, short);
}

/// Seconds since 1970, whose last place is more than a millionth of a sample time; times that are added up, in double and single precision.
#[test]
fn steps_are_told_from_rounded_times() {
    let begun_at = |start| {
        let part = Part::new(&rig::MODEL);
        assert_eq!(fmi3EnterInitializationMode(part.handle, false, 0.0, start, false, 0.0), Status::Ok);
        assert_eq!(fmi3ExitInitializationMode(part.handle), Status::Ok);
        part
    };
    let start = 1.7e9;
    let part = begun_at(start);
    for tick in 0..1000 {
        let [from, end] = [tick, tick + 1].map(|tick| start + f64::from(tick) * 0.11);
        assert_eq!(part.step(from, end - from), Status::Ok, "{tick}");
    }
    part.tells(part.step(part.real("time").1, 0.1101), Status::Error, &["the step is"]);

    let (double, single) = (begun_at(start), begun_at(0.0));
    let (mut wide, mut narrow) = (start, 0.0_f32);
    for tick in 0..20_000 {
        assert_eq!(double.step(wide, 0.11), Status::Ok, "{tick}");
        assert_eq!(single.step(f64::from(narrow), f64::from(0.11_f32)), Status::Ok, "{tick}");
        (wide, narrow) = (wide + 0.11, narrow + 0.11);
    }
}

#[test]
fn a_wrong_parameter_is_named_when_the_model_begins() {
    for (model, name, value, words) in [
        (&*rig::MODEL, "preset", "kettle", ["kettle", "trainer"]),
        (&*rig::MODEL, "disturbance", "wild", ["wild", "none, calm or lively"]),
        (&*rig::MODEL, "scenario", "[rig]\ngian = 1", ["line 2", "gian"]),
        (&*rig::MODEL, "scenario", "[[action]]\nat = 1\nfan = 50", ["action", "inputs"]),
        (&*rig::MODEL, "scenario", "none.toml", ["can't read", "none.toml"]),
        (&*rig::MODEL, "fault2.kind", "ofset", ["fault2.kind", "offset"]),
        (&*rig::MODEL, "fault2.kind", "offset", ["fault2", "`sensor` is missing"]),
        (&*instrument::MODEL, "preset", "kettle", ["kettle", "trainer"]),
        (&*instrument::MODEL, "configuration", "setpoint = = 3", ["configuration", "line 1"]),
        (&*instrument::MODEL, "configuration", "setpoint = 500.0", ["setpoint", "500"]),
        (&*instrument::MODEL, "configuration", "none.toml", ["can't read", "none.toml"]),
    ] {
        let part = Part::new(model);
        assert_eq!(part.set_text(name, value), Status::Ok);
        assert_eq!(part.initialize(), Status::Ok);
        part.tells(part.real("step_size").0, Status::Error, &words);
        part.tells(fmi3ExitInitializationMode(part.handle), Status::Error, &words);
        assert_eq!(part.set_text(name, ""), Status::Ok);
        assert_eq!(fmi3ExitInitializationMode(part.handle), Status::Ok, "{name} can be set right");
    }
}

#[test]
fn parameters_count_until_the_initialization_ends() {
    let part = Part::new(&rig::MODEL);
    part.initialize();
    assert_eq!(part.real("step_size"), (Status::Ok, 0.11));
    assert_eq!(part.set_text("preset", "tclab"), Status::Ok);
    assert_eq!(part.real("step_size"), (Status::Ok, 5.0));
    assert_eq!(fmi3ExitInitializationMode(part.handle), Status::Ok);
    assert_eq!(part.step(0.0, 5.0), Status::Ok);
}

/// Lukewarm everywhere: it heats once it is armed, not before, and not after.
#[test]
fn the_instrument_heats_only_while_it_is_armed() {
    let part = Part::begun(&instrument::MODEL);
    for code in ["code_t0", "code_t1", "code_t2"] {
        part.set_real(code, 2160.0);
    }
    let mut now = 0.0;
    let mut power = || {
        assert_eq!(part.step(now, 0.11), Status::Ok);
        now += 0.11;
        part.real("power").1
    };
    assert_eq!(power(), 0.0);
    part.set_flag("arm", true);
    assert!(power() > 0.0);
    assert_eq!(part.text("mode"), "settle");
    part.set_flag("arm", false);
    assert_eq!((power(), part.text("mode")), (0.0, "off".into()));
}

#[test]
fn what_the_instrument_refuses_to_do_is_a_warning() {
    let part = Part::begun(&instrument::MODEL);
    part.set_real("setpoint", 500.0);
    part.tells(part.step(0.0, 0.11), Status::Warning, &["SetPoint", "refused", "500"]);
    assert_eq!(part.step(0.11, 0.11), Status::Ok, "it is told once");
    fmi3SetDebugLogging(part.handle, false, 0, null());
    part.set_real("setpoint", 600.0);
    assert_eq!(part.step(0.22, 0.11), Status::Warning);
    assert!(part.told.lock().unwrap().is_empty(), "no warning is told when logging is off");
}

#[test]
fn descriptions_list_every_variable_by_its_place() {
    let tokens = models().map(Model::token);
    assert_ne!(tokens[0], tokens[1]);
    for (model, token) in models().into_iter().zip(tokens) {
        let xml = description::model_description(model).unwrap();
        assert!(xml.contains(&format!("instantiationToken=\"{token}\"")));
        for (place, variable) in model.variables.iter().enumerate() {
            let head = format!("name=\"{}\" valueReference=\"{place}\"", variable.name);
            assert!(xml.contains(&head), "{head}");
            let unit = format!("<Unit name=\"{}\">", variable.unit);
            assert!(variable.unit.is_empty() || xml.contains(&unit), "{unit}");
        }
        let terminals = description::terminals().unwrap();
        for member in TERMINALS.iter().flat_map(|terminal| terminal.members) {
            assert!(model.variables.iter().any(|variable| variable.name == *member));
            assert!(terminals.contains(&format!("variableName=\"{member}\"")), "{member}");
        }
    }
}
