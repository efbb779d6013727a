//! The checkout's own text, for the tests of its habits: which files there are, and what of them is code.

use std::fs;
use std::path::{Path, PathBuf};

/// A text file of the checkout.
#[derive(Clone, Debug)]
pub struct Source {
    /// Path from the root of the checkout, with `/`.
    pub path: String,
    /// What stands in it.
    pub text: String,
}

impl Source {
    /// A file that exists only in a test.
    pub fn sample(path: &str, text: &str) -> Source {
        Source { path: path.into(), text: text.into() }
    }

    /// Is it Rust?
    pub fn is_rust(&self) -> bool {
        self.path.ends_with(".rs")
    }

    /// The text with comments and the contents of literals blanked; every line keeps its number and its length in
    /// characters.
    pub fn code(&self) -> String {
        blank(&self.text, false)
    }

    /// The same without what is built for tests only.
    pub fn code_without_tests(&self) -> String {
        without_tests(&self.code())
    }

    /// The text with everything blanked but comments.
    pub fn comments(&self) -> String {
        blank(&self.text, true)
    }
}

/// The root of the checkout.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("this crate is a folder of the workspace").into()
}

/// The folder of shared scenes: in `JERBOA_SHARED`, or in `shared` beside the checkout. None where it is not at hand.
pub fn shared_scenes() -> Option<PathBuf> {
    let shared = std::env::var_os("JERBOA_SHARED").map_or_else(|| root().join("../shared"), PathBuf::from);
    Some(shared.join("scenes")).filter(|scenes| scenes.is_dir())
}

/// Every text file of the checkout, by path: neither build outputs, nor what git keeps, nor `shared`, which holds scenes and
/// is no part of it.
pub fn sources() -> Vec<Source> {
    let root = root();
    let mut found = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the checkout can be listed") {
            let path = entry.expect("an entry of a folder can be read").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let outside = ["target", "shared", ".git"].contains(&name.as_str()) && folder == root;
            if outside {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else if let Ok(text) = fs::read_to_string(&path) {
                let path = path.strip_prefix(&root).expect("it lies below the root");
                found.push(Source { path: path.to_string_lossy().replace('\\', "/"), text });
            }
        }
    }
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

/// What a stretch of Rust is.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    Code,
    LineComment,
    /// With the number of comments it is nested in.
    BlockComment(u32),
    Text,
    /// With its number of `#`.
    RawText(usize),
}

/// Replace by blanks: comments and the contents of literals, or (`keep_comments`) everything else.
fn blank(text: &str, keep_comments: bool) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut out = String::with_capacity(text.len());
    let mut part = Part::Code;
    let mut i = 0;
    while i < chars.len() {
        let rest = &chars[i..];
        // How far this step goes, what it belongs to, and what follows.
        let (len, of, then) = match part {
            Part::Code => match rest {
                ['/', '/', ..] => (2, Part::LineComment, Part::LineComment),
                ['/', '*', ..] => (2, Part::BlockComment(1), Part::BlockComment(1)),
                ['"', ..] => (1, Part::Code, Part::Text),
                ['r', ..] if raw_string(&chars, i).is_some() => {
                    let hashes = raw_string(&chars, i).unwrap_or(0);
                    (hashes + 2, Part::Code, Part::RawText(hashes))
                }
                // A character literal, not a lifetime.
                ['\'', '\\', ..] => {
                    let end = rest.iter().skip(3).position(|c| *c == '\'').map_or(rest.len(), |n| n + 4);
                    (end, Part::Text, Part::Code)
                }
                ['\'', _, '\'', ..] => (3, Part::Text, Part::Code),
                _ => (1, Part::Code, Part::Code),
            },
            Part::LineComment => match rest {
                ['\n', ..] => (1, part, Part::Code),
                _ => (1, part, part),
            },
            Part::BlockComment(depth) => match rest {
                ['*', '/', ..] => (2, part, if depth == 1 { Part::Code } else { Part::BlockComment(depth - 1) }),
                ['/', '*', ..] => (2, part, Part::BlockComment(depth + 1)),
                _ => (1, part, part),
            },
            Part::Text => match rest {
                ['\\', ..] => (2, part, part),
                ['"', ..] => (1, Part::Code, Part::Code),
                _ => (1, part, part),
            },
            Part::RawText(hashes) => match rest {
                ['"', after @ ..] if after.len() >= hashes && after[..hashes].iter().all(|c| *c == '#') => {
                    (hashes + 1, Part::Code, Part::Code)
                }
                _ => (1, part, part),
            },
        };
        let keep = match of {
            Part::Code => !keep_comments,
            Part::LineComment | Part::BlockComment(_) => keep_comments,
            Part::Text | Part::RawText(_) => false,
        };
        let end = (i + len).min(chars.len());
        out.extend(chars[i..end].iter().map(|c| if keep || *c == '\n' { *c } else { ' ' }));
        (i, part) = (end, then);
    }
    out
}

/// Does a raw string begin at this `r`? Its number of `#`.
fn raw_string(chars: &[char], at: usize) -> Option<usize> {
    let before = at.checked_sub(1).map_or(' ', |i| chars[i]);
    if is_word(before) && before != 'b' {
        return None;
    }
    let hashes = chars[at + 1..].iter().take_while(|c| **c == '#').count();
    (chars.get(at + 1 + hashes) == Some(&'"')).then_some(hashes)
}

/// Can it be a character of an identifier?
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Blank every item behind a `#[cfg(test)]`: up to its `;`, or to the end of its braces.
fn without_tests(code: &str) -> String {
    let marker = "#[cfg(test)]";
    let mut out = String::with_capacity(code.len());
    let mut rest = code;
    while let Some(at) = rest.find(marker) {
        out.push_str(&rest[..at]);
        let mut depth = 0;
        let end = rest[at..].char_indices().find_map(|(i, c)| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            ((c == ';' || c == '}') && depth == 0).then_some(at + i + 1)
        });
        let end = end.unwrap_or(rest.len());
        out.extend(rest[at..end].chars().map(|c| if c == '\n' { c } else { ' ' }));
        rest = &rest[end..];
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_and_comments_are_told_apart() {
        let text = "let a = \"x // no\"; // yes\nlet b = 'q'; /* yes /* yes */ yes */ let c = r#\"no \" no\"#;\nfn f<'a>() {}\n";
        let source = Source::sample("a.rs", text);
        let code = source.code();
        assert_eq!(code.lines().count(), 3);
        assert!(!code.contains("no") && !code.contains("yes") && !code.contains('q'), "{code}");
        assert!(code.contains("let c") && code.contains("fn f<'a>() {}"), "{code}");
        let comments = source.comments();
        assert_eq!(comments.matches("yes").count(), 4);
        assert!(!comments.contains("let") && !comments.contains("no"), "{comments}");
    }

    #[test]
    fn what_is_built_for_tests_is_left_out() {
        let text =
            "#[cfg(test)]\nuse a::b;\nfn kept() {}\n#[cfg(test)]\nmod tests { fn f() { if x { y } } }\nfn last() {}\n";
        let code = Source::sample("a.rs", text).code_without_tests();
        assert!(code.contains("fn kept() {}") && code.contains("fn last() {}"), "{code}");
        assert!(!code.contains("mod tests") && !code.contains("use"), "{code}");
    }

    #[test]
    fn the_checkout_is_found() {
        let paths: Vec<String> = sources().into_iter().map(|s| s.path).collect();
        for expected in ["Cargo.toml", ".ci/run", "ir/src/lib.rs", "tests/src/sources.rs"] {
            assert!(paths.iter().any(|p| p == expected), "{expected} is missing from {} files", paths.len());
        }
        assert!(!paths.iter().any(|p| p.starts_with("target/") || p.starts_with(".git/")));
    }
}
