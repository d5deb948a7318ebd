//! `pt326 campaign --parquet`: the rows of runs.csv with their types, where the program was built for it.

#[cfg(feature = "parquet")]
use crate::campaign;
use crate::{SMALL, fails, folder};

#[test]
fn a_part_writes_no_tables_and_a_program_without_the_feature_says_how_to_get_it() {
    let (dir, file) = folder("parquet-refused", SMALL);
    let out = dir.join("out");
    let args = [&file, "--out", out.to_str().unwrap(), "--parquet", "--shard", "1/2"];
    let error = fails(&args);
    let expected = if cfg!(feature = "parquet") { "a part writes no tables" } else { "--features parquet" };
    assert!(error.contains(expected), "{error}");
    assert!(!out.exists(), "nothing was begun");
}

#[cfg(feature = "parquet")]
#[test]
fn it_is_read_back_as_the_rows_of_runs_csv() {
    use parquet::basic::Type;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    let (dir, file) = folder("parquet", SMALL);
    let out = dir.to_str().unwrap();
    let printed = campaign(&[&file, "--out", out, "--parquet"]);
    assert!(printed.status.success(), "{}", String::from_utf8_lossy(&printed.stderr));
    assert!(String::from_utf8_lossy(&printed.stdout).trim_end().ends_with("runs.parquet"));

    let mut csv = csv::Reader::from_path(dir.join("runs.csv")).unwrap();
    let names: Vec<String> = csv.headers().unwrap().iter().map(str::to_owned).collect();
    let reader = SerializedFileReader::new(std::fs::File::open(dir.join("runs.parquet")).unwrap()).unwrap();
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let types: Vec<(&str, Type)> = schema.columns().iter().map(|c| (c.name(), c.physical_type())).collect();
    assert_eq!(types.iter().map(|(name, _)| *name).collect::<Vec<_>>(), names);
    for typed in [
        ("cell", Type::BYTE_ARRAY),
        ("seed", Type::INT64),
        ("likelihood_armed", Type::BOOLEAN),
        ("likelihood_detection_delay_s", Type::DOUBLE),
        ("likelihood_alarms", Type::INT64),
        ("said_end_right", Type::BOOLEAN),
    ] {
        assert!(types.contains(&typed), "{typed:?} is not in {types:?}");
    }

    let as_in_csv = |field: &Field| match field {
        Field::Null => String::new(),
        Field::Bool(is_so) => u8::from(*is_so).to_string(),
        Field::ULong(n) => n.to_string(),
        Field::Double(x) => x.to_string(),
        Field::Str(text) => text.clone(),
        other => panic!("{other:?} is of a type that runs.csv has not"),
    };
    let read: Vec<Vec<String>> = reader
        .get_row_iter(None)
        .unwrap()
        .map(|row| row.unwrap().get_column_iter().map(|(_, field)| as_in_csv(field)).collect())
        .collect();
    let written: Vec<Vec<String>> =
        csv.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect();
    assert_eq!(written.len(), 9, "six of the fault, three of the silence");
    assert_eq!(read, written);
}
