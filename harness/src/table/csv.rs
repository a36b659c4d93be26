//! Comma-separated values, RFC 4180 with line feeds.

use super::{Table, Values, real_text};

impl Table {
    /// The table with a line of names and a line a row; empty fields where a row has no value.
    pub fn csv(&self) -> String {
        let mut text = line(self.columns.iter().map(|column| column.name.clone()));
        for row in 0..self.rows {
            text += &line(self.columns.iter().map(|column| field(&column.values, row)));
        }
        text
    }
}

fn line(fields: impl Iterator<Item = String>) -> String {
    fields.map(|field| quoted(&field)).collect::<Vec<_>>().join(",") + "\n"
}

fn field(values: &Values, row: usize) -> String {
    let field = match values {
        Values::Text(values) => values[row].clone(),
        Values::Count(values) => values[row].map(|count| count.to_string()),
        Values::Real(values) => values[row].map(real_text),
        Values::Flag(values) => values[row].map(|flag| flag.to_string()),
    };
    field.unwrap_or_default()
}

fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Column;

    #[test]
    fn fields_read_back() {
        let column = |name: &str, values| Column { name: name.into(), about: "", values };
        let table = Table {
            rows: 2,
            columns: vec![
                column("a,b", Values::Text(vec![Some("say \"no\"\nor so".into()), None])),
                column("n", Values::Real(vec![Some(0.1 + 0.2), Some(1e-300)])),
                column("c", Values::Count(vec![None, Some(u64::MAX)])),
                column("f", Values::Flag(vec![Some(true), None])),
                column("r", Values::Real(vec![Some(4.0), None])),
            ],
        };
        let expected = "\"a,b\",n,c,f,r\n\"say \"\"no\"\"\nor so\",0.30000000000000004,,true,4\n\
                        ,1e-300,18446744073709551615,,\n";
        assert_eq!(table.csv(), expected);
    }
}
