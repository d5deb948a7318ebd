use super::*;

#[test]
fn a_case_is_the_same_each_time_and_survives_being_written() {
    for number in 0..200 {
        let case = Case::draw(number);
        case.scenario.validate().unwrap();
        let text = toml::to_string(&case).unwrap();
        assert_eq!(toml::from_str::<Case>(&text).unwrap(), case, "{text}");
        assert_eq!(Case::draw(number), case);
    }
}
