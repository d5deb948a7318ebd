//! Logs that are no tables yet, made such.

/// Klipper's log as a table: of each `Stats` line the time, the number of starts so far, and of each heater `temp` and `pwm`. After a shutdown
/// the log repeats what was measured and asked for last: these lines are left out. A row stands on the line that it is from. `None` of what is no such log.
pub(super) fn klipper(text: &str) -> Option<String> {
    let (mut sessions, mut is_down) = (1, false);
    let mut heaters: Vec<&str> = Vec::new();
    let mut stats = Vec::new();
    for (number, line) in text.lines().enumerate() {
        if line.starts_with("Start printer at") || line.starts_with("Starting Klippy") {
            (sessions, is_down) = (sessions + 1, false);
        }
        is_down |= line.starts_with("Transition to shutdown state") || line.contains("' shutdown: ");
        let Some((time, rest)) = line.split_once("Stats ").and_then(|(_, rest)| rest.split_once(": ")) else {
            continue;
        };
        let of = of_heaters(rest);
        if is_down || of.is_empty() {
            continue;
        }
        for (name, ..) in &of {
            if !heaters.contains(name) {
                heaters.push(name);
            }
        }
        stats.push((number, time, sessions, of));
    }
    // The hot end first: it is what most ask about.
    heaters.sort_by_key(|name| !name.starts_with("extruder"));
    let columns = heaters.iter().map(|name| format!(",{name}_temp,{name}_pwm"));
    let mut out = format!("t_s,session{}\n", columns.collect::<String>());
    let mut written = 1;
    for (number, time, session, of) in &stats {
        (written..*number).for_each(|_| out.push('\n'));
        written = number + 1;
        out += &format!("{time},{session}");
        for name in &heaters {
            let (_, temp, pwm) = of.iter().find(|(of, ..)| of == name).unwrap_or(&("", "", ""));
            out += &format!(",{temp},{pwm}");
        }
        out.push('\n');
    }
    (!stats.is_empty()).then_some(out)
}

/// Name, `temp` and `pwm` of each heater of a `Stats` line: `extruder: target=200 temp=199.5 pwm=0.413`.
fn of_heaters(stats: &str) -> Vec<(&str, &str, &str)> {
    let mut heaters: Vec<(&str, &str, &str)> = Vec::new();
    for word in stats.split_whitespace() {
        if let Some(name) = word.strip_suffix(':') {
            heaters.push((name, "", ""));
        } else if let (Some(last), Some((key, value))) = (heaters.last_mut(), word.split_once('=')) {
            match key {
                "temp" => last.1 = value,
                "pwm" => last.2 = value,
                _ => {}
            }
        }
    }
    heaters.retain(|(_, temp, pwm)| !temp.is_empty() && !pwm.is_empty());
    heaters
}

/// Artisan's table without the line of properties before its header.
pub(super) fn artisan(text: &str) -> Option<&str> {
    let (first, rest) = text.split_once('\n')?;
    (first.contains("CHARGE:") && rest.starts_with("Time1")).then_some(rest)
}

#[cfg(test)]
mod tests {
    use super::super::format::guess;
    use super::super::map::Map;
    use super::super::table::Table;
    use super::*;

    #[test]
    fn lines_of_a_printers_log_are_a_table_of_all_heaters_and_starts() {
        let stats = |t: u32, bed: &str, pwm: &str| {
            format!(
                "Stats {t}.5: gcodein=0  mcu: mcu_awake=0.0 heater_bed: target=60 temp={bed} pwm=0.2 sysload=0.1 print_stall=0 extruder: target=200 temp=199.5 pwm={pwm}\n"
            )
        };
        let log = [
            "Start printer at Wed May  1 10:00:00 2024 (1714550400.0 9.0)\n",
            &stats(10, "59.9", "0.413"),
            "other\n",
            "Transition to shutdown state: Heater extruder not heating at expected rate\n",
            &stats(11, "59.9", "1.000"),
            "Start printer at Wed May  1 10:10:00 2024 (1714551000.0 2.0)\n",
            &stats(3, "0.0", "0.000"),
        ]
        .concat();
        let text = klipper(&log).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines,
            [
                "t_s,session,extruder_temp,extruder_pwm,heater_bed_temp,heater_bed_pwm",
                "10.5,2,199.5,0.413,59.9,0.2",
                "",
                "",
                "",
                "",
                "3.5,3,199.5,0.000,0.0,0.2"
            ]
        );
        let guess = guess(&Table::parse("f".into(), &text).unwrap()).unwrap();
        assert_eq!((guess.name, guess.full_power), (Some("Klipper's log"), Some(1.0)));
        let maps: Vec<String> = guess.heaters.iter().map(Map::to_string).collect();
        assert_eq!(
            maps,
            [
                "time=t_s t1=extruder_temp power=extruder_pwm session=session",
                "time=t_s t1=heater_bed_temp power=heater_bed_pwm session=session"
            ]
        );
        assert_eq!(klipper("t,u\n1,2\n"), None);
    }
}
