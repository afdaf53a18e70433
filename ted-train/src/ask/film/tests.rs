//! A studio with a source that writes down what it was asked for.

use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use super::cache::Cache;
use super::plan::{Plan, batches};
use super::studio::{Progress, Studio};
use super::videos::Projector;
use super::{FilmSource, NoFilm};
use crate::dataset::fixtures::{SHAPE, records};
use crate::dataset::{Dataset, Segment, Video, Videos};

/// Makes a still that says its episode and step, and fails at some episode.
struct Scribe {
    asked: Sender<(u32, Vec<u32>)>,
    fails_at: Option<u32>,
    ready: bool,
}

impl FilmSource for Scribe {
    fn prepare(&mut self) -> Result<(), NoFilm> {
        self.ready.then_some(()).ok_or(NoFilm("no light".into()))
    }

    fn stills(&mut self, episode: u32, steps: &[u32]) -> Result<Vec<Vec<u8>>, NoFilm> {
        let _ = self.asked.send((episode, steps.to_vec()));
        if self.fails_at == Some(episode) {
            return Err(NoFilm("no more light".into()));
        }
        Ok(steps.iter().map(|step| still(episode, *step)).collect())
    }
}

fn scribe() -> (Scribe, Receiver<(u32, Vec<u32>)>) {
    let (asked, heard) = channel();
    let scribe = Scribe {
        asked,
        fails_at: None,
        ready: true,
    };
    (scribe, heard)
}

fn still(episode: u32, step: u32) -> Vec<u8> {
    let text = format!("{episode} {step}");
    [&[0xFF, 0xD8], text.as_bytes(), &[0xFF, 0xD9]].concat()
}

fn dataset() -> Dataset {
    Dataset::from_records("ted/x-v0", SHAPE, &records(&[500, 500, 30])).unwrap()
}

fn whole(dataset: &Dataset, episode: u32) -> Segment {
    let len = dataset.episodes()[episode as usize].len;
    Segment::new(dataset, episode, 0, len as u32).unwrap()
}

/// Waits until this holds.
fn until(studio: &Studio, holds: impl Fn(&Progress) -> bool) -> Progress {
    let deadline = Instant::now() + Duration::from_secs(30);
    loop {
        let progress = studio.progress();
        if holds(&progress) {
            return progress;
        }
        assert!(Instant::now() < deadline, "{progress:?}");
        std::thread::yield_now();
    }
}

fn complete(progress: &Progress) -> bool {
    progress.all[1] > 0 && progress.all[0] == progress.all[1]
}

#[test]
fn a_film_has_a_hundred_stills_at_most_and_comes_coarsely_first_with_its_end() {
    let dataset = dataset();
    let plans = [whole(&dataset, 0), whole(&dataset, 2)].map(Plan::of);
    assert_eq!((plans[0].every, plans[0].stills), (5, 100));
    assert_eq!((plans[1].every, plans[1].stills), (1, 30));
    let made: Vec<(usize, u32)> = batches(&plans)
        .flat_map(|batch| {
            batch
                .stills
                .into_iter()
                .map(move |still| (batch.side, still))
        })
        .collect();
    let first = made
        .iter()
        .position(|&(side, still)| !plans[side].is_first(still));
    // 0, 8, ..., 96 and 99 of the long one; 0, 8, 16, 24 and 29 of the short one.
    assert_eq!(first, Some(14 + 5));
    assert!(made[..19].contains(&(0, 99)) && made[..19].contains(&(1, 29)));
    let mut each = made.clone();
    each.sort_unstable();
    each.dedup();
    assert_eq!((each.len(), made.len()), (130, 130), "each of them once");
    let clip = Segment::new(&dataset, 1, 100, 250).unwrap();
    let plan = Plan::of(clip);
    assert_eq!((plan.every, plan.stills, plan.step(83)), (3, 84, 349));
}

#[test]
fn a_studio_makes_what_is_shown_and_gives_it_out_by_its_place_alone() {
    let dataset = dataset();
    let (scribe, _heard) = scribe();
    let studio = Studio::open(scribe, None);
    assert_eq!(studio.progress(), Progress::default());
    assert_eq!(studio.still(0, 0), None);
    studio.show([whole(&dataset, 0), whole(&dataset, 2)]);
    let progress = until(&studio, complete);
    assert_eq!((progress.first, progress.all), ([19, 19], [130, 130]));
    assert_eq!(progress.films[0].every, 5);
    assert_eq!(studio.still(0, 3).unwrap(), still(0, 15));
    assert_eq!(studio.still(1, 29).unwrap(), still(2, 29));
    for (side, place) in [(0, 100), (1, 30), (2, 0), (0, u32::MAX)] {
        assert_eq!(studio.still(side, place), None, "{side} {place}");
    }
    // The next question forgets the one before, but for the clip that both have.
    studio.show([whole(&dataset, 2), whole(&dataset, 1)]);
    assert_eq!(studio.progress().films[0].made.len(), 30);
    let progress = until(&studio, complete);
    assert_eq!(progress.films[1].made.len(), 100);
    assert_eq!(studio.still(0, 3).unwrap(), still(2, 3));
}

#[test]
fn what_was_made_before_is_not_made_again_and_a_broken_file_is() {
    let dataset = dataset();
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    let film = |from: &Path| {
        let (scribe, heard) = scribe();
        let studio = Studio::open(scribe, Some(Cache::beside(from, "key")));
        studio.show([whole(&dataset, 2), whole(&dataset, 2)]);
        until(&studio, complete);
        (studio, heard)
    };
    let (studio, heard) = film(folder.path());
    let made: usize = heard.try_iter().map(|(_, steps)| steps.len()).sum();
    assert_eq!(made, 30, "the same clip on both sides is made once");
    // It is kept a little later, each under another name first.
    let kept = folder.path().join("pictures/key/2");
    let deadline = Instant::now() + Duration::from_secs(30);
    while !(0..30).all(|step| kept.join(format!("{step}.jpg")).exists()) {
        assert!(Instant::now() < deadline);
        std::thread::yield_now();
    }
    drop(studio);
    std::fs::write(kept.join("7.jpg"), b"\xFF\xD8 torn").unwrap();
    // The data folder is another name of the dataset.
    let (studio, heard) = film(&folder.path().join("data"));
    assert_eq!(heard.try_iter().collect::<Vec<_>>(), [(2, vec![7])]);
    assert_eq!(studio.still(1, 7).unwrap(), still(2, 7));
}

#[test]
fn trouble_is_told_and_what_was_made_before_it_stays() {
    let dataset = dataset();
    let (mut fails, _heard) = scribe();
    fails.fails_at = Some(1);
    let studio = Studio::open(fails, None);
    studio.show([whole(&dataset, 0), whole(&dataset, 1)]);
    let progress = until(&studio, |progress| progress.trouble.is_some());
    assert_eq!(progress.trouble.as_deref(), Some("no more light"));
    assert_eq!(progress.films[0].made.len(), 14);
    // Another question's episodes have nothing to do with it.
    studio.show([whole(&dataset, 0), whole(&dataset, 2)]);
    assert_eq!(until(&studio, complete).trouble, None);

    let (mut dark, heard) = scribe();
    dark.ready = false;
    let studio = Studio::open(dark, None);
    studio.show([whole(&dataset, 0), whole(&dataset, 1)]);
    let progress = until(&studio, |progress| progress.trouble.is_some());
    assert_eq!(progress.trouble.as_deref(), Some("no light"));
    assert_eq!(heard.try_iter().count(), 0);

    let studio = Studio::closed(&NoFilm("nobody there".into()));
    studio.show([whole(&dataset, 0), whole(&dataset, 1)]);
    assert_eq!(studio.progress().trouble.as_deref(), Some("nobody there"));
}

#[test]
fn videos_are_those_of_cameras_that_saw_both_clips_each_from_where_its_clip_begins() {
    let dataset = dataset();
    let (logs, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    std::fs::create_dir(folder.path().join("data")).unwrap();
    let video = |camera: &str, path: &str, from_s| Video {
        camera: camera.into(),
        path: path.into(),
        from_s,
        step_s: 0.5,
        frame_s: 0.25,
    };
    let seen = vec![
        vec![video("wrist", "w.mp4", 0.0), video("top", "t.mp4", 1.0)],
        vec![video("top", "t.mp4", 300.0), video("side", "s.mp4", 0.0)],
        vec![video("side", "s.avi", 7.0)],
    ];
    assert!(Projector::of(folder.path()).unwrap().is_none());
    Videos::of(logs.path(), seen).write(folder.path()).unwrap();
    let studio = || Studio::of_videos(Projector::of(folder.path()).unwrap().unwrap());
    let clips = |one, other| [one, other].map(|it| Segment::new(&dataset, it, 10, 20).unwrap());

    // A file that is gone, and one that is there.
    let gone = studio();
    gone.show(clips(0, 1));
    let trouble = gone.progress().trouble.unwrap();
    assert!(trouble.contains("t.mp4 is gone; put it back"), "{trouble}");
    assert_eq!((gone.progress().videos, gone.video(0, 0)), (None, None));
    for file in ["w.mp4", "t.mp4", "s.mp4", "s.avi"] {
        std::fs::write(logs.path().join(file), file).unwrap();
    }
    let studio = studio();
    assert_eq!(studio.progress(), Progress::default());
    studio.show(clips(0, 1));
    let progress = studio.progress();
    assert_eq!((progress.trouble, progress.all), (None, [0, 0]));
    let take = |from_s| serde_json::json!([{"from_s": from_s, "step_s": 0.5, "frame_s": 0.25}]);
    assert_eq!(
        serde_json::to_value(progress.videos).unwrap(),
        serde_json::json!({"cameras": ["top"], "takes": [take(6.0), take(305.0)]})
    );
    assert!(studio.video(1, 0).unwrap().ends_with("t.mp4"));
    for (side, camera) in [(0, 1), (2, 0), (0, usize::MAX)] {
        assert_eq!(studio.video(side, camera), None, "{side} {camera}");
    }
    // What goes wrong with one question says nothing of another.
    for (both, why) in [((0, 2), "no camera saw both"), ((2, 2), "no browser plays")] {
        studio.show([whole(&dataset, both.0), whole(&dataset, both.1)]);
        let trouble = studio.progress().trouble.unwrap();
        assert!(
            trouble.contains(why) && studio.video(0, 0).is_none(),
            "{trouble}"
        );
    }
    studio.show(clips(1, 1));
    assert_eq!(studio.progress().trouble, None);
    assert!(studio.video(1, 1).unwrap().ends_with("s.mp4"));
}
