//! The simulator's states that an episode recorded beside what is learned from.

use std::fs;
use std::path::Path;

use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_array::{Array, RecordBatch};
use firmware_sim::bridge::State;

use super::PART;
use super::arrow_file::record_batches;
use super::reader::data_folder;
use crate::dataset::DatasetError;

/// The states of an episode of the dataset at `path`, one before each step and one after the last; none where it recorded none.
///
/// # Errors
/// When the episode's file cannot be read.
pub(crate) fn states(path: &Path, episode: u32) -> Result<Option<Vec<State>>, DatasetError> {
    let path = data_folder(path)?.join(episode.to_string()).join(PART);
    let place = path.display().to_string();
    let bytes = fs::read(&path).map_err(|source| DatasetError::Read { path, source })?;
    let batches = record_batches(bytes, &["infos"])
        .map_err(|reason| DatasetError::Damaged { place, reason })?;
    let mut states = Vec::new();
    for batch in &batches {
        let Some(qpos) = rows(batch, "qpos") else {
            return Ok(None);
        };
        // A simulator without mocap bodies has no such columns.
        let none = || vec![Vec::new(); qpos.len()];
        let mocap_pos = rows(batch, "mocap_pos").unwrap_or_else(none);
        let mocap_quat = rows(batch, "mocap_quat").unwrap_or_else(none);
        let mocap = mocap_pos.into_iter().zip(mocap_quat);
        states.extend(
            (qpos.into_iter().zip(mocap)).map(|(qpos, (mocap_pos, mocap_quat))| State {
                qpos,
                mocap_pos,
                mocap_quat,
            }),
        );
    }
    Ok(Some(states))
}

/// The rows of an info; none unless it is lists of doubles, a value in each place.
fn rows(batch: &RecordBatch, name: &str) -> Option<Vec<Vec<f64>>> {
    let column = batch
        .column_by_name("infos")?
        .as_struct_opt()?
        .column_by_name(name)?;
    let lists = column.as_fixed_size_list_opt()?;
    let values = lists.values().as_primitive_opt::<Float64Type>()?;
    let width = usize::try_from(lists.value_length())
        .ok()
        .filter(|&width| width > 0)?;
    let whole = lists.null_count() == 0 && values.null_count() == 0;
    whole.then(|| {
        values
            .values()
            .chunks_exact(width)
            .map(<[f64]>::to_vec)
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::dataset::fixtures::records;
    use crate::dataset::minari::tests::complete;

    #[test]
    fn the_states_of_an_episode_are_those_that_were_recorded() {
        let (_root, folder) = complete();
        let found = states(&folder, 2).unwrap().unwrap();
        assert_eq!(found.len(), 6, "one before each of 5 steps, and one after");
        let recorded = &records(&[6, 4, 5, 7])[2].infos[0];
        let qpos: Vec<f64> = found.iter().flat_map(|it| it.qpos.clone()).collect();
        assert_eq!((recorded.name.as_str(), &recorded.values), ("qpos", &qpos));
        assert!(found.iter().all(|it| it.mocap_pos.is_empty()));
        assert_eq!(states(&folder.join("data"), 2).unwrap().unwrap(), found);
    }

    #[test]
    fn an_episode_that_is_missing_or_torn_is_an_error() {
        let (_root, folder) = complete();
        assert!(matches!(states(&folder, 9), Err(DatasetError::Read { .. })));
        let part = folder.join("data/2").join(PART);
        let bytes = fs::read(&part).unwrap();
        fs::write(&part, &bytes[..bytes.len() / 2]).unwrap();
        assert!(matches!(
            states(&folder, 2),
            Err(DatasetError::Damaged { .. })
        ));
    }
}
