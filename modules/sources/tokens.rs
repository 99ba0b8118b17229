//! Rust text as its tokens, without comments, and which of them only tests are built of.

/// A word, a literal or one sign; `::` is one token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    /// As it is written.
    pub text: &'a str,
    /// Line in the file, from 1.
    pub line: usize,
    /// Whether white space or a comment stands before it: `& &` is not `&&`.
    pub is_apart: bool,
}

/// The tokens of a file whose line ends are single line feeds.
///
/// Texts, also raw ones, and comments, also nested ones, are told from code. Documentation is a
/// comment here, though the compiler makes attributes of it: no result depends on it.
pub fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let (mut place, mut line, mut is_apart) = (0, 1, true);
    while let Some(first) = text[place..].chars().next() {
        let rest = &text[place..];
        let blank = blank_length(rest, first);
        let length = if blank > 0 { blank } else { token_length(rest, first) };
        let piece = &rest[..length];
        if blank == 0 {
            tokens.push(Token { text: piece, line, is_apart });
        }
        is_apart = blank > 0;
        line += piece.matches('\n').count();
        place += length;
    }
    tokens
}

/// Bytes of the white space or comment that `rest` begins with; 0 for a token.
fn blank_length(rest: &str, first: char) -> usize {
    if first.is_whitespace() {
        return first.len_utf8();
    }
    if rest.starts_with("//") {
        return rest.find('\n').unwrap_or(rest.len());
    }
    if !rest.starts_with("/*") {
        return 0;
    }
    let (mut depth, mut place) = (0, 0);
    while place < rest.len() {
        let step = match rest.as_bytes().get(place..place + 2) {
            Some(b"/*") => 1,
            Some(b"*/") => -1,
            _ => 0,
        };
        depth += step;
        place += if step == 0 { 1 } else { 2 };
        if depth == 0 {
            return place;
        }
    }
    rest.len()
}

fn token_length(rest: &str, first: char) -> usize {
    match first {
        '"' => text_length(rest, 0),
        '\'' => quote_length(rest),
        _ if is_word(first) => {
            let word = rest.find(|sign| !is_word(sign)).unwrap_or(rest.len());
            let next = rest[word..].chars().next();
            match (&rest[..word], next) {
                ("r" | "br" | "cr", Some('"' | '#')) => raw_text_length(rest, word),
                ("b" | "c", Some('"')) => text_length(rest, word),
                _ => word,
            }
        }
        ':' if rest.starts_with("::") => 2,
        _ => first.len_utf8(),
    }
}

fn is_word(sign: char) -> bool {
    sign.is_alphanumeric() || sign == '_'
}

/// Bytes of a text whose opening quote is at `quote`.
fn text_length(rest: &str, quote: usize) -> usize {
    let mut is_escaped = false;
    for (place, byte) in rest.bytes().enumerate().skip(quote + 1) {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' => is_escaped = true,
            b'"' => return place + 1,
            _ => {}
        }
    }
    rest.len()
}

/// Bytes of `r#"…"#`, or of a name such as `r#type`, whose first word has `prefix` bytes.
fn raw_text_length(rest: &str, prefix: usize) -> usize {
    let n_signs = rest[prefix..].bytes().take_while(|&byte| byte == b'#').count();
    let start = prefix + n_signs;
    if !rest[start..].starts_with('"') {
        let name = &rest[start..];
        return start + name.find(|sign| !is_word(sign)).unwrap_or(name.len());
    }
    let end = format!("\"{}", "#".repeat(n_signs));
    let content = &rest[start + 1..];
    content.find(&end).map_or(rest.len(), |place| start + 1 + place + end.len())
}

/// Bytes of a character in quotes, or of a lifetime.
fn quote_length(rest: &str) -> usize {
    let mut signs = rest.char_indices().skip(1);
    match signs.next() {
        Some((_, '\\')) => {
            let from = 1 + signs.next().map_or(1, |(_, sign)| 1 + sign.len_utf8());
            rest[from..].find('\'').map_or(rest.len(), |place| from + place + 1)
        }
        Some(_) => match signs.next() {
            Some((place, '\'')) => place + 1,
            _ => 1 + rest[1..].find(|sign| !is_word(sign)).unwrap_or(rest.len() - 1),
        },
        None => 1,
    }
}

/// What of a file is there without tests.
pub struct WithoutTests<'a> {
    /// The tokens.
    pub tokens: Vec<Token<'a>>,
    /// Modules in files of their own that only tests have: the name, and the path if it is said.
    pub test_modules: Vec<(&'a str, Option<&'a str>)>,
}

/// Leaves out each item behind `#[cfg(test)]`. What is not sure to be an item stays.
pub fn without_tests<'a>(all: &[Token<'a>]) -> WithoutTests<'a> {
    let mut left = WithoutTests { tokens: Vec::new(), test_modules: Vec::new() };
    let is = |place: usize, texts: &[&str]| {
        texts
            .iter()
            .enumerate()
            .all(|(k, text)| all.get(place + k).is_some_and(|t| t.text == *text))
    };
    let mut place = 0;
    while place < all.len() {
        if is(place, &["#", "[", "cfg", "(", "test", ")", "]"])
            && let Some(end) = item_end(all, place)
        {
            left.test_modules.extend(module_of(&all[place..end]));
            place = end;
        } else {
            left.tokens.push(all[place]);
            place += 1;
        }
    }
    left
}

/// Where the item ends whose attributes begin at `place`.
fn item_end(all: &[Token], mut place: usize) -> Option<usize> {
    while all.get(place)?.text == "#" {
        place = group_end(all, place + 1)?;
    }
    if all.get(place)?.text == "pub" {
        place += 1;
        if all.get(place)?.text == "(" {
            place = group_end(all, place)?;
        }
    }
    let is_function = all.get(place + 1)?.text == "fn";
    let ends_in_braces = match all.get(place)?.text {
        "mod" | "fn" | "impl" | "trait" | "struct" | "enum" | "unsafe" => true,
        "const" if is_function => true,
        "use" | "const" | "static" | "type" => false,
        _ => return None,
    };
    loop {
        let text = all.get(place)?.text;
        match text {
            ";" => return Some(place + 1),
            "{" if ends_in_braces => return group_end(all, place),
            "{" | "(" | "[" => place = group_end(all, place)?,
            _ => place += 1,
        }
    }
}

/// Where the brackets end that open at `place`.
fn group_end(all: &[Token], mut place: usize) -> Option<usize> {
    let mut depth = 0;
    loop {
        match all.get(place)?.text {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        place += 1;
        if depth == 0 {
            return Some(place);
        }
    }
}

/// The name and the path of an item `mod name;`.
fn module_of<'a>(item: &[Token<'a>]) -> Option<(&'a str, Option<&'a str>)> {
    let [.., word, name, end] = item else { return None };
    if (word.text, end.text) != ("mod", ";") {
        return None;
    }
    let is_path = |three: &&[Token]| three[0].text == "path" && three[1].text == "=";
    let path = item.windows(3).find(is_path).map(|three| three[2].text.trim_matches('"'));
    Some((name.text, path))
}
