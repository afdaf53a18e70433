//! Which lines of a file are heard when a question is asked, and what they say together.
//!
//! A line is about two clips, whichever of them is shown first, and it does not matter where in the file it stands or which run it
//! comes from. Everybody who said something about the two is heard. Of somebody who did so more than once, the first line is heard
//! the first time that a run asks, the second line the second time, and the last one from then on: so a run's own log gives
//! every answer back where it was given. Where people disagree, more votes for one clip than for the other decide, and as many for
//! either are a tie: two answers that contradict each other say as much as one that calls the clips equal.

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
    let mut people: Vec<(&str, Vec<usize>)> = Vec::new();
    for (index, Numbered { line, .. }) in lines.iter().enumerate() {
        if line.about(clips).is_some() {
            match people.iter_mut().find(|(by, _)| *by == line.by) {
                Some((_, own)) => own.push(index),
                None => people.push((&line.by, vec![index])),
            }
        }
    }
    let turn = |own: &Vec<usize>| own[before.min(own.len() - 1)];
    let heard: Vec<usize> = people.iter().map(|(_, own)| turn(own)).collect();
    let said = match heard.as_slice() {
        [] => return None,
        &[only] => Said {
            answer: lines[only].line.about(clips)?,
            by: lines[only].line.by.clone(),
            at: lines[only].line.at.clone(),
        },
        several => {
            let votes = several
                .iter()
                .filter_map(|&index| lines[index].line.about(clips)?);
            let by: Vec<&str> = people.iter().map(|(by, _)| *by).collect();
            Said {
                answer: together(votes),
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
