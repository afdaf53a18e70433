//! The log against kills, edits, other datasets and full disks.

use super::*;
use crate::dataset::fixtures::{SHAPE, records};
use crate::dataset::{Clip, Segment, SegmentSampler};
use crate::preferences::{
    Context, Query, Recovered, ReplayTeacher, Said, Says, ScriptedTeacher, TeacherConfig,
};
use crate::rng::Seed;
use std::fs;
use tempfile::TempDir;

fn dataset() -> Dataset {
    Dataset::from_records("ted/x-v0", SHAPE, &records(&[20, 30, 25])).unwrap()
}

/// Seven questions of single members and three that are shared, as the reward ensemble asks them; the fourth is a tie.
fn questions(dataset: &Dataset) -> Vec<Question> {
    let sampler = SegmentSampler::new(dataset, Clip::Steps(5)).unwrap();
    let mut rng = Seed::root(4).rng();
    (0_u32..10)
        .map(|index| {
            let member = (index < 7).then_some(index);
            let round = index.saturating_sub(6);
            let [first, other] = [sampler.sample(&mut rng), sampler.sample(&mut rng)];
            let second = if index == 3 { first } else { other };
            let segments = [first, second];
            Question {
                context: Context { round, member },
                query: Query { segments },
                why: (index == 8).then(|| "to see".to_owned()),
            }
        })
        .collect()
}

fn interview(
    path: &Path,
    dataset: &Dataset,
    teacher: &mut dyn Teacher,
    count: usize,
) -> Vec<Option<Answer>> {
    let mut log = PreferenceLog::open(path, dataset).unwrap();
    let ask = |question| log.ask(dataset, teacher, question).unwrap();
    questions(dataset)
        .into_iter()
        .take(count)
        .map(ask)
        .collect()
}

fn complete(dataset: &Dataset) -> (TempDir, PathBuf, Vec<Option<Answer>>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("preferences.jsonl");
    let answers = interview(&path, dataset, &mut ScriptedTeacher::truthful(), 10);
    (folder, path, answers)
}

/// A teacher that must not be asked.
struct Nobody;

impl Teacher for Nobody {
    fn answer(
        &mut self,
        _: &Dataset,
        asked: &[LogEntry],
        _: &Question,
    ) -> Result<Said, PreferenceError> {
        Err(PreferenceError::NotAnswered {
            path: PathBuf::new(),
            number: asked.len() + 1,
            account: String::new(),
            line: String::new(),
        })
    }
}

fn refusal(path: &Path, dataset: &Dataset) -> String {
    PreferenceLog::open(path, dataset)
        .map(|_| ())
        .expect_err("must be refused")
        .to_string()
}

fn edit_line(path: &Path, line: usize, change: impl Fn(&str) -> String) {
    let text = fs::read_to_string(path).unwrap();
    let lines: Vec<_> = text
        .lines()
        .enumerate()
        .map(|(at, text)| {
            if at + 1 == line {
                change(text)
            } else {
                text.into()
            }
        })
        .collect();
    fs::write(path, lines.join("\n") + "\n").unwrap();
}

#[test]
fn a_line_says_everything_about_a_question_and_its_answer() {
    let dataset = dataset();
    let (_folder, path, _) = complete(&dataset);
    let text = fs::read_to_string(path).unwrap();
    let line: serde_json::Value = serde_json::from_str(text.lines().nth(8).unwrap()).unwrap();
    assert_eq!(line["dataset"], "ted/x-v0");
    assert_eq!(line["digest"], dataset.digest());
    assert_eq!(
        (&line["round"], &line["member"]),
        (&2.into(), &serde_json::Value::Null)
    );
    assert_eq!(line["segments"][1]["length"], 5);
    assert_eq!(line["by"], "teacher:true-return");
    assert_eq!(line["why"], "to see");
    assert_eq!(text.matches("\"why\"").count(), 1, "others have no reason");
    let answers: Vec<_> = text
        .lines()
        .map(|line| line.split("\"answer\":").nth(1).unwrap())
        .collect();
    assert!(answers.iter().any(|answer| answer.starts_with("0,")));
    assert!(answers.iter().any(|answer| answer.starts_with("1,")));
    assert!(answers.iter().any(|answer| answer.starts_with("0.5,")));
}

#[test]
fn a_run_that_starts_again_asks_nobody_twice() {
    let dataset = dataset();
    let (_folder, path, answers) = complete(&dataset);
    let before = fs::read(&path).unwrap();
    assert_eq!(interview(&path, &dataset, &mut Nobody, 10), answers);
    assert_eq!(fs::read(&path).unwrap(), before);
}

#[test]
fn a_run_that_was_killed_half_way_goes_on_to_the_same_file() {
    let dataset = dataset();
    let (folder, path, answers) = complete(&dataset);
    let other = folder.path().join("killed.jsonl");
    let teacher = &mut ScriptedTeacher::truthful();
    interview(&other, &dataset, teacher, 6);
    assert_eq!(interview(&other, &dataset, teacher, 10), answers);
    assert_eq!(fs::read(other).unwrap(), fs::read(path).unwrap());
}

#[test]
fn a_log_replayed_into_a_new_run_gives_the_same_log() {
    let dataset = dataset();
    let (folder, path, answers) = complete(&dataset);
    let copy = folder.path().join("copy.jsonl");
    let mut replay = ReplayTeacher::open(&path, &dataset).unwrap();
    assert_eq!(interview(&copy, &dataset, &mut replay, 10), answers);
    assert_eq!(fs::read(copy).unwrap(), fs::read(&path).unwrap());
    // A question that is asked once more is answered as it was; one that it says nothing about is named.
    let held = PreferenceLog::read(&path, &dataset).unwrap();
    let question = &questions(&dataset)[8];
    let again = replay.answer(&dataset, &held, question).unwrap();
    assert_eq!(again, held[8].said);
    let logged = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = logged.lines().collect();
    let nine = [&lines[..8], &lines[9..]].concat().join("\n");
    let short = folder.path().join("nine.jsonl");
    fs::write(&short, nine).unwrap();
    let mut replay = ReplayTeacher::open(&short, &dataset).unwrap();
    let error = replay.answer(&dataset, &held[..8], question).unwrap_err();
    let error = error.to_string();
    let start = format!(
        "{} does not answer question 9 (8 of 9 lines are used; not line 9: the run does not ask about its two clips): ",
        short.display()
    );
    assert!(error.starts_with(&start), "{error}");
    // The line that it wants, as it stands in a log but for the answer and who gave it.
    let (_, line) = error.split_once("tell: ").unwrap();
    let logged = lines[8];
    let asked = |line: &str| line.split_once("\"answer\":").unwrap().0.to_owned();
    assert_eq!(asked(line), asked(logged));
    assert!(line.ends_with("\"answer\":null,\"by\":\"me\"}"), "{line}");
}

#[test]
fn another_question_than_the_logged_one_is_named() {
    let dataset = dataset();
    let (_folder, path, _) = complete(&dataset);
    let questions = questions(&dataset);
    let asked = |context, index: usize| Question {
        context,
        ..questions[index].clone()
    };
    let mut log = PreferenceLog::open(&path, &dataset).unwrap();
    let error = log
        .ask(&dataset, &mut Nobody, asked(questions[0].context, 1))
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("question 1 is not the one in the log: asked about episode"),
        "{error}"
    );
    let context = Context {
        round: 0,
        member: Some(5),
    };
    assert!(log.ask(&dataset, &mut Nobody, asked(context, 0)).is_err());
}

#[test]
fn a_log_cut_at_any_byte_keeps_all_whole_answers() {
    let dataset = dataset();
    let (folder, path, answers) = complete(&dataset);
    let bytes = fs::read(&path).unwrap();
    let cut_path = folder.path().join("cut.jsonl");
    // The last two lines byte by byte, and the empty file.
    let from = bytes
        .iter()
        .enumerate()
        .filter(|(_, byte)| **byte == b'\n')
        .nth(7)
        .unwrap()
        .0
        + 1;
    for cut in (from..=bytes.len()).chain([0]) {
        fs::write(&cut_path, &bytes[..cut]).unwrap();
        let line_ends = bytes[..cut].iter().filter(|&&byte| byte == b'\n').count();
        let only_the_line_end_is_lost = bytes.get(cut) == Some(&b'\n');
        let expected = line_ends + usize::from(only_the_line_end_is_lost);
        let log = PreferenceLog::open(&cut_path, &dataset).unwrap();
        assert_eq!(log.entries().len(), expected, "cut at {cut}");
        let inside_a_line =
            bytes[..cut].last().is_some_and(|&byte| byte != b'\n') && !only_the_line_end_is_lost;
        assert_eq!(
            log.recovered().map(|recovered| recovered.kept),
            inside_a_line.then_some(line_ends)
        );
        drop(log);
        let teacher = &mut ScriptedTeacher::truthful();
        assert_eq!(interview(&cut_path, &dataset, teacher, 10), answers);
        assert_eq!(fs::read(&cut_path).unwrap(), bytes, "cut at {cut}");
    }
}

#[test]
fn what_a_recovery_drops_is_told() {
    let dataset = dataset();
    let (_folder, path, _) = complete(&dataset);
    let whole = fs::read(&path).unwrap();
    fs::write(&path, [whole.as_slice(), b"{\"dataset\":\"te"].concat()).unwrap();
    assert_eq!(PreferenceLog::read(&path, &dataset).unwrap().len(), 10);
    let log = PreferenceLog::open(&path, &dataset).unwrap();
    assert_eq!(
        log.recovered(),
        Some(&Recovered {
            kept: 10,
            dropped: "{\"dataset\":\"te".into()
        })
    );
    assert_eq!(fs::read(&path).unwrap(), whole);
}

#[test]
fn a_broken_line_in_the_middle_is_an_error_with_its_number() {
    let dataset = dataset();
    let (_folder, path, _) = complete(&dataset);
    let refuse = |change: fn(&str) -> String| {
        let whole = fs::read(&path).unwrap();
        edit_line(&path, 4, change);
        let broken = fs::read(&path).unwrap();
        let text = refusal(&path, &dataset);
        assert_eq!(
            fs::read(&path).unwrap(),
            broken,
            "a refused file is left as it is"
        );
        fs::write(&path, whole).unwrap();
        assert!(text.starts_with("line 4 of "), "{text}");
        text
    };
    assert!(refuse(|line| line[..40].into()).contains("is not a preference"));
    assert!(
        refuse(|line| line.replace("\"round\"", "\"rounds\"")).contains("unknown field `rounds`")
    );
    assert!(
        refuse(|line| line.replace("\"length\":5", "\"length\":500")).contains("run past its end")
    );
    let answer = |line: &str, answer: &str| {
        let (before, after) = line.split_once("\"answer\":").unwrap();
        let (_, after) = after.split_once(',').unwrap();
        format!("{before}\"answer\":{answer},{after}")
    };
    assert!(
        refuse(|line| line.replace("\"answer\":", "\"answer\":1,\"x\":")).contains("unknown field")
    );
    for wrong in ["2", "-1", "0.25", "0.50001"] {
        edit_line(&path, 4, |line| answer(line, wrong));
        let text = refusal(&path, &dataset);
        assert!(
            text.starts_with("line 4 of ")
                && text.contains(&format!("the answer {wrong} is not 0 (first better)")),
            "{text}"
        );
    }
    let without = |line: &str| {
        let (before, after) = line.split_once("\"answer\":").unwrap();
        format!("{before}{}", after.split_once(',').unwrap().1)
    };
    let whole = fs::read(&path).unwrap();
    edit_line(&path, 4, without);
    assert!(refusal(&path, &dataset).contains("missing field `answer`"));
    fs::write(&path, whole).unwrap();
    edit_line(&path, 4, |line| answer(line, "\"first\""));
    assert!(refusal(&path, &dataset).contains("is not a preference"));
}

#[test]
fn who_cannot_tell_is_logged_and_replayed_and_is_no_answer() {
    let dataset = dataset();
    let folder = tempfile::tempdir().unwrap();
    let [path, copy] = ["a", "b"].map(|name| folder.path().join(name));
    let config = TeacherConfig {
        says: Says::First,
        cannot_tell: 0.5,
        ..TeacherConfig::default()
    };
    let mut teacher = ScriptedTeacher::new(config, Seed::root(1));
    let answers = interview(&path, &dataset, &mut teacher, 10);
    let untold = answers.iter().filter(|answer| answer.is_none()).count();
    assert!((1..10).contains(&untold), "{answers:?}");
    let text = fs::read_to_string(&path).unwrap();
    assert_eq!(text.matches("\"answer\":null,").count(), untold);
    assert_eq!(
        text.matches("\"by\":\"teacher:first,cannot_tell=0.5\"")
            .count(),
        10
    );
    let mut replay = ReplayTeacher::open(&path, &dataset).unwrap();
    assert_eq!(interview(&copy, &dataset, &mut replay, 10), answers);
    assert_eq!(fs::read_to_string(&copy).unwrap(), text);
    // What a log holds beyond the questions of a run that starts again does not count before it is asked.
    let log = PreferenceLog::open(&path, &dataset).unwrap();
    assert_eq!((log.untold().count(), log.answered()), (0, 0));
}

#[test]
fn a_log_about_another_dataset_is_refused() {
    let dataset = dataset();
    let (_folder, path, _) = complete(&dataset);
    let mut episodes = records(&[20, 30, 25]);
    episodes[2].rewards[3] += 1.0;
    let other = Dataset::from_records("ted/x-v0", SHAPE, &episodes).unwrap();
    let text = refusal(&path, &other);
    assert!(
        text.starts_with("line 1 of ")
            && text.contains(dataset.digest())
            && text.contains(other.digest())
    );
    assert!(ReplayTeacher::open(&path, &other).is_err());
}

#[cfg(target_os = "linux")]
#[test]
fn an_answer_that_cannot_be_kept_is_an_error_and_not_an_answer() {
    let dataset = dataset();
    let (_folder, path, _) = complete(&dataset);
    let before = fs::read(&path).unwrap();
    let mut log = PreferenceLog::open(&path, &dataset).unwrap();
    log.asked = 10;
    log.file = OpenOptions::new().write(true).open("/dev/full").unwrap();
    let segment = Segment::new(&dataset, 0, 0, 5).unwrap();
    let context = Context {
        round: 4,
        member: None,
    };
    let query = Query {
        segments: [segment; 2],
    };
    let question = Question {
        context,
        query,
        why: None,
    };
    let error = log
        .ask(&dataset, &mut ScriptedTeacher::truthful(), question)
        .unwrap_err();
    assert!(matches!(error, PreferenceError::DiskFull { .. }), "{error}");
    assert_eq!(log.entries().len(), 10);
    assert_eq!(fs::read(&path).unwrap(), before);
}

#[test]
fn the_digest_covers_the_whole_lines() {
    let dataset = dataset();
    let (_folder, path, _) = complete(&dataset);
    let digest = PreferenceLog::open(&path, &dataset)
        .unwrap()
        .digest()
        .unwrap();
    assert_eq!(
        digest,
        blake3::hash(&fs::read(&path).unwrap()).to_hex().as_str()
    );
}

#[test]
fn what_an_editor_leaves_of_a_log_is_gone_on_with_or_refused_with_a_way_out() {
    let dataset = dataset();
    let (_folder, path, answers) = complete(&dataset);
    let text = fs::read_to_string(&path).unwrap();
    let six: usize = text.split_inclusive('\n').take(6).map(str::len).sum();
    // A mark, other ends of lines, an empty line and no end of the last one.
    let edited = format!(
        "\u{feff}{}",
        text[..six].trim_end().replacen('\n', "\r\n\r\n", 2)
    );
    fs::write(&path, &edited).unwrap();
    let teacher = &mut ScriptedTeacher::truthful();
    assert_eq!(interview(&path, &dataset, teacher, 10), answers);
    let whole = fs::read_to_string(&path).unwrap();
    assert_eq!(whole, format!("{edited}\n{}", &text[six..]));
    // A whole last line that is wrong is no torn one: it is somebody's word.
    let wrong = text.trim_end().replace("\"by\"", "\"sby\"");
    fs::write(&path, &wrong).unwrap();
    assert!(refusal(&path, &dataset).contains("unknown field `sby`"));
    let last = text.trim_end().rsplit_once('\n').unwrap().1;
    fs::write(&path, last.replace("\"by\"", "\"sby\"")).unwrap();
    assert!(refusal(&path, &dataset).starts_with("line 1 of "));
    let wide: Vec<u8> = format!("\u{feff}{text}")
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    fs::write(&path, &wide).unwrap();
    assert!(refusal(&path, &dataset).contains("--merge FILE` writes all of it as UTF-8"));
    assert_eq!(fs::read(&path).unwrap(), wide);
}
