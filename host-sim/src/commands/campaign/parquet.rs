//! `runs.parquet`: the rows of runs.csv with their types.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use anyhow::Context;
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use pt326_host::campaign::cell::Cell;
use pt326_host::campaign::output::field::{Field, Value};
use pt326_host::campaign::output::run_fields;
use pt326_host::campaign::run::RunRow;

/// Rows that are held as columns at a time.
const GROUP: usize = 50_000;

/// Writes a row for each run.
///
/// # Errors
/// The file can't be written.
pub(super) fn write_runs(cells: &[Cell], rows: &[RunRow], path: &Path) -> anyhow::Result<()> {
    let place = || format!("can't write {}", path.display());
    let fields = |row: &RunRow| run_fields(&cells[row.cell], row);
    let columns = rows.first().map(fields).context("no run, so nothing to write")?;
    let mut file = SerializedFileWriter::new(
        File::create(path).with_context(place)?,
        Arc::new(schema(&columns)?),
        Arc::new(WriterProperties::default()),
    )
    .with_context(place)?;
    for group in rows.chunks(GROUP) {
        let mut columns: Vec<Vec<Value>> = vec![Vec::with_capacity(group.len()); columns.len()];
        for row in group {
            columns.iter_mut().zip(fields(row)).for_each(|(column, (_, value))| column.push(value));
        }
        let mut group = file.next_row_group().with_context(place)?;
        columns.iter().try_for_each(|column| write_column(&mut group, column)).with_context(place)?;
        group.close().with_context(place)?;
    }
    file.close().with_context(place)?;
    Ok(())
}

fn schema(columns: &[Field]) -> anyhow::Result<Type> {
    let column = |(name, value): &Field| {
        let (physical, logical) = match value {
            Value::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Value::Real(_) => (Physical::DOUBLE, None),
            Value::Count(_) => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Value::Flag(_) => (Physical::BOOLEAN, None),
        };
        let column = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
        anyhow::Ok(Arc::new(column.with_logical_type(logical).build()?))
    };
    let columns = columns.iter().map(column).collect::<anyhow::Result<_>>()?;
    Ok(Type::group_type_builder("run").with_fields(columns).build()?)
}

fn write_column<W: std::io::Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    column: &[Value],
) -> anyhow::Result<()> {
    let mut writer = group.next_column()?.context("a column too many")?;
    let writer_of = &mut writer;
    match column {
        [Value::Text(_), ..] => put::<ByteArrayType>(writer_of, column, |value| match value {
            Value::Text(text) => text.as_deref().map(ByteArray::from),
            _ => None,
        }),
        [Value::Real(_), ..] => put::<DoubleType>(writer_of, column, |value| match value {
            Value::Real(x) => *x,
            _ => None,
        }),
        [Value::Count(_), ..] => put::<Int64Type>(writer_of, column, |value| match value {
            Value::Count(n) => n.map(u64::cast_signed),
            _ => None,
        }),
        _ => put::<BoolType>(writer_of, column, |value| match value {
            Value::Flag(is_so) => *is_so,
            _ => None,
        }),
    }?;
    Ok(writer.close()?)
}

/// Those that are there, and of each whether it is.
fn put<T: DataType>(
    writer: &mut SerializedColumnWriter<'_>,
    column: &[Value],
    of: impl Fn(&Value) -> Option<T::T>,
) -> anyhow::Result<()> {
    let cells: Vec<Option<T::T>> = column.iter().map(of).collect();
    let levels: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
    let values: Vec<T::T> = cells.into_iter().flatten().collect();
    writer.typed::<T>().write_batch(&values, Some(&levels), None)?;
    Ok(())
}
