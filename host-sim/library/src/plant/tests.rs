//! A small plant of the same shape as Tennessee Eastman's files, made here: a cooling valve with a negative gain and its controller.

use super::*;

/// Settings of it; `{}` is for more.
const SETTINGS: &str = r#"
about = "made"
signals = 3
training = "normal.dat"
normal = "again.dat"
onset = 160
skip = 20
low_pass = 0.15
quantile = 0.99
window = 100
faults = [
  { what = "warmer water", file = "warm_te.dat", again = "warm.dat", name = 1 },
  { what = "unsteady water", file = "unsteady_te.dat", again = "unsteady.dat" },
]
[[model]]
name = "temperature"
output = 1
order = 2
inputs = [{ signal = 3, order = 2, delay = 1 }]
[[model]]
name = "controller"
output = 3
order = 1
inputs = [{ signal = 1, order = 2, delay = 0 }]
[[name]]
says = "warmer water"
signs = ["+.", "0."]
"#;

/// A reproducible number within +-1.
fn noise(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    (*state >> 8) as f32 / 8_388_608.0 - 1.0
}

/// Rows of temperature, a signal that nobody uses, and the valve. From `onset` on the water is warmer, or unsteady.
fn rows(seed: u32, onset: usize, warmer: f32, unsteady: f32) -> Vec<[f32; 3]> {
    let (mut state, mut t, mut valve) = (seed, 0.0, 0.0);
    let row = |k: usize| {
        valve = 0.5 * valve + t + 0.15 * noise(&mut state);
        let row = [120.0 + t, 5.0 + noise(&mut state), 41.0 + valve];
        let [warmer, unsteady] = if k >= onset { [warmer, unsteady] } else { [0.0; 2] };
        t = 0.8 * t - 0.1 * valve + (0.1 + unsteady) * noise(&mut state) + warmer;
        row
    };
    (0..500).map(row).collect()
}

fn write(dir: &Path, file: &str, rows: &[[f32; 3]], is_turned: bool) {
    let line = |cells: Vec<f32>| cells.iter().map(|x| format!("{x:e} ")).collect::<String>();
    let text: Vec<String> = match is_turned {
        false => rows.iter().map(|row| line(row.to_vec())).collect(),
        true => (0..3).map(|signal| line(rows.iter().map(|row| row[signal]).collect())).collect(),
    };
    std::fs::write(dir.join(file), text.join("\n")).unwrap();
}

fn folder() -> std::path::PathBuf {
    let dir = std::env::temp_dir().join(format!("pt326-plant-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    for (file, seed, onset, warmer, unsteady) in [
        ("normal.dat", 1, 0, 0.0, 0.0),
        ("again.dat", 2, 0, 0.0, 0.0),
        ("warm_te.dat", 3, 160, 0.4, 0.0),
        ("warm.dat", 4, 0, 0.4, 0.0),
        ("unsteady_te.dat", 5, 160, 0.0, 0.2),
        ("unsteady.dat", 6, 0, 0.0, 0.2),
    ] {
        write(&dir, file, &rows(seed, onset, warmer, unsteady), file == "normal.dat");
    }
    dir
}

#[test]
fn a_cooling_loop_is_learnt_and_its_faults_are_detected_and_named() {
    let dir = folder();
    let plant = Plant::parse(SETTINGS).unwrap();
    let scored = plant.score(&dir).unwrap();
    let [warm, unsteady] = &scored.faults[..] else { panic!("two faults") };
    assert!(scored.false_alarms.iter().all(|share| *share < 0.05), "{scored:?}");
    assert!(warm.detected > 0.95 && warm.delay.is_some_and(|delay| delay < 10), "{warm:?}");
    assert!(warm.named.iter().all(|named| named[0] > 0.5), "{warm:?}");
    // What is unsteady has no mean: without the squares it is seen in a fifth of the samples.
    assert!(unsteady.detected > 0.9 && unsteady.named.iter().all(|named| named[0] == 0.0), "{unsteady:?}");
    assert!(scored.false_names[0] == 0.0);
    let text = score(SETTINGS, &dir).unwrap();
    assert!(text.contains(&format!("| warmer water | {:.3} |", warm.detected)), "{text}");
    std::fs::remove_dir_all(dir).unwrap();
}

#[test]
fn settings_that_fit_nothing_are_refused_by_name() {
    for (from, to, said) in [
        ("output = 3", "output = 4", "model controller: signal 4, expected 1 to 3"),
        ("order = 2\n", "order = 20\n", "model temperature: 23 parameters"),
        ("\"+.\", \"0.\"", "\"+.\"", "1 signs for 2 models"),
        ("\"0.\"", "\"0?\"", "expected two of"),
        ("name = 1", "name = 2", "expected 1 to 1"),
        ("low_pass = 0.15", "low_pass = 1.5", "low_pass is 1.5"),
    ] {
        let error = format!("{:#}", Plant::parse(&SETTINGS.replace(from, to)).unwrap_err());
        assert!(error.contains(said), "{error}");
    }
    assert!(format!("{:#}", settings_of("nobody.toml").unwrap_err()).contains("nor one of lbnl, tep"));
    assert!(Plant::parse(&settings_of("tep").unwrap()).is_ok());
    assert!(AirHandler::parse(&settings_of("lbnl").unwrap()).is_ok());
}
