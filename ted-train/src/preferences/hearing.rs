//! Which lines of a file are heard when a question is asked, and what they say together.
//!
//! A line is about two clips, whichever of them is shown first, and it does not matter where in the file it stands or which run it
//! comes from. Everybody who said something about the two is heard. Of somebody who did so more than once, the first line is heard
//! the first time that a run asks, the second line the second time, and the last one from then on: so a run's own log gives
//! every answer back where it was given. Where people disagree, more votes for one clip than for the other decide, and as many for
//! either are a tie: two answers that contradict each other say as much as one that calls the clips equal.
//!
//! A line that puts the question off has no part in that. It is heard alone and once: the second of all lines about the two clips,
//! say, the second time that a run asks about them. The others are heard as if the run had not asked that time.

use std::cmp::Ordering;

use super::{Answer, Numbered, Said, Span};

/// What was said, and by which of the lines, as indices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Heard {
    pub said: Said,
    pub lines: Vec<usize>,
}

/// What the lines say of two clips that were asked about so many times before; none if nothing.
pub(super) fn hear(lines: &[Numbered], clips: [Span; 2], before: usize) -> Option<Heard> {
    let about = |&index: &usize| lines[index].line.about(clips).is_some();
    let puts_off = |index: &usize| lines[*index].line.puts_off();
    let all: Vec<usize> = (0..lines.len()).filter(about).collect();
    if let Some(&only) = all.get(before).filter(|it| puts_off(it)) {
        return Some(Heard {
            said: lines[only].line.said(),
            lines: vec![only],
        });
    }
    let turn = before - all.iter().take(before).filter(|it| puts_off(it)).count();
    let mut people: Vec<(&str, Vec<usize>)> = Vec::new();
    for index in all.into_iter().filter(|it| !puts_off(it)) {
        let by = lines[index].line.by.as_str();
        match people.iter_mut().find(|(known, _)| *known == by) {
            Some((_, own)) => own.push(index),
            None => people.push((by, vec![index])),
        }
    }
    let of_turn = |own: &Vec<usize>| own[turn.min(own.len() - 1)];
    let heard: Vec<usize> = people.iter().map(|(_, own)| of_turn(own)).collect();
    let said = match heard.as_slice() {
        [] => return None,
        &[only] => Said {
            answer: lines[only].line.about(clips)?,
            ..lines[only].line.said()
        },
        several => {
            let votes = several
                .iter()
                .filter_map(|&index| lines[index].line.about(clips)?);
            let by: Vec<&str> = people.iter().map(|(by, _)| *by).collect();
            Said {
                answer: together(votes),
                later: false,
                by: by.join(", "),
                at: None,
            }
        }
    };
    Some(Heard { said, lines: heard })
}

/// What votes come to; none without a vote.
fn together(votes: impl Iterator<Item = Answer>) -> Option<Answer> {
    let for_second = |vote| match vote {
        Answer::First => -1,
        Answer::Equal => 0,
        Answer::Second => 1,
    };
    let balance: i32 = votes.map(for_second).reduce(|all, one| all + one)?;
    Some(match balance.cmp(&0) {
        Ordering::Less => Answer::First,
        Ordering::Equal => Answer::Equal,
        Ordering::Greater => Answer::Second,
    })
}

#[cfg(test)]
#[path = "hearing_tests.rs"]
mod tests;
