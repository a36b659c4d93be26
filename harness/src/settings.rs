//! Settings of parameters: `order=4`, `order=2..6`, `p=2,4`, `self-shadow=paper,continuous`, and the grids that they span.

use crate::Error;

/// The most values that one setting may list: a slip such as `order=2..6000000` is refused, not run.
const MOST: usize = 1000;

/// A parameter's name and the values that it takes in turn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The parameter.
    pub name: String,
    /// Its values, as text; a method's declaration decides what they mean.
    pub values: Vec<String>,
}

impl std::str::FromStr for Setting {
    type Err = Error;

    /// Reads `name=values`, where values are separated by commas and `a..b` stands for the integers from a to b, both included.
    fn from_str(text: &str) -> Result<Self, Error> {
        let wrong = |message: &str| Error::Setting { text: text.to_owned(), message: message.to_owned() };
        let (name, values) = text.split_once('=').ok_or_else(|| wrong("expected NAME=VALUES, such as order=2..6"))?;
        let name = name.trim();
        if name.is_empty() {
            return Err(wrong("expected a parameter's name before `=`"));
        }
        Ok(Self { name: name.to_owned(), values: expand(values).map_err(|message| wrong(&message))? })
    }
}

/// All values that a text such as `2..6` or `2,4` stands for.
pub(crate) fn expand(text: &str) -> Result<Vec<String>, String> {
    let mut values = Vec::new();
    for part in text.split(',').map(str::trim) {
        match part.split_once("..") {
            Some((from, to)) => values.extend(range(part, from, to)?),
            None if part.is_empty() => return Err("expected a value between commas and after `=`".into()),
            None => values.push(part.to_owned()),
        }
        if values.len() > MOST {
            return Err(format!("expected at most {MOST} values"));
        }
    }
    Ok(values)
}

fn range(text: &str, from: &str, to: &str) -> Result<impl Iterator<Item = String>, String> {
    let wrong = || format!("expected a range A..B of integers with A not above B, found `{text}`");
    let (from, to): (i64, i64) = (from.parse().map_err(|_| wrong())?, to.parse().map_err(|_| wrong())?);
    if from > to {
        return Err(wrong());
    }
    if to.abs_diff(from) >= MOST as u64 {
        return Err(format!("expected at most {MOST} values, found `{text}`"));
    }
    Ok((from..=to).map(|v| v.to_string()))
}

/// Every combination of the settings' values, the last setting varying fastest; one empty combination for no settings.
pub(crate) fn grid(settings: &[&Setting]) -> Vec<Vec<(String, String)>> {
    settings.iter().fold(vec![Vec::new()], |points, setting| {
        let extend = |point: &Vec<(String, String)>, value: &String| {
            let mut point = point.clone();
            point.push((setting.name.clone(), value.clone()));
            point
        };
        points.iter().flat_map(|point| setting.values.iter().map(move |value| extend(point, value))).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read() {
        let values = |text: &str| text.parse::<Setting>().map(|s| s.values.join(" ")).map_err(|e| e.to_string());
        assert_eq!(values("order=2..6").unwrap(), "2 3 4 5 6");
        assert_eq!(values("order=-1..1, 7").unwrap(), "-1 0 1 7");
        assert_eq!(values("p=2,4").unwrap(), "2 4");
        assert_eq!(values("self-shadow=paper").unwrap(), "paper");
        assert_eq!(values("x=0.5").unwrap(), "0.5");
        for bad in
            ["order", "=3", "order=", "order=6..2", "order=2..x", "order=1..1000000000000", "p=2,,3", "x=0.1..0.5"]
        {
            let message = values(bad).unwrap_err();
            assert!(message.starts_with(&format!("--set {bad}: expected")), "{message}");
        }
    }

    #[test]
    fn a_grid_holds_every_combination() {
        let settings: Vec<Setting> = ["a=1,2", "b=x,y,z"].iter().map(|s| s.parse().unwrap()).collect();
        let points = grid(&settings.iter().collect::<Vec<_>>());
        assert_eq!(points.len(), 6);
        assert_eq!(points[1], [("a".into(), "1".into()), ("b".into(), "y".into())]);
        assert_eq!(grid(&[]), [[]]);
    }
}
