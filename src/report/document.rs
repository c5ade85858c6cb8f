//! Reports of text, tables and figures: as one HTML file that needs nothing else, and as Markdown.

use maud::{DOCTYPE, Markup, PreEscaped, html};

/// What makes a page readable, on screens and on paper.
const STYLE: &str = "body{font:16px/1.45 system-ui,sans-serif;max-width:1120px;margin:2em auto;padding:0 1em;color:#222}\
h1{font-size:1.7em}h2{font-size:1.25em;margin-top:2em;border-bottom:1px solid #ccc}\
table{border-collapse:collapse;font-size:.86em;margin:.8em 0;display:block;overflow-x:auto}\
th,td{padding:.2em .7em;text-align:right;border-bottom:1px solid #e4e4e4;white-space:nowrap}\
th:first-child,td:first-child{text-align:left}th{background:#f4f4f4}tbody tr:nth-child(even){background:#fafafa}\
figure{margin:1em 0}figure svg{max-width:100%;height:auto}figcaption{font-size:.9em;color:#555}\
pre{background:#f6f6f6;padding:.8em;overflow-x:auto;font-size:.85em}";

/// Names of columns, and rows of as many cells.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// The names.
    pub header: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<String>>,
}

/// A drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// The stem of its file.
    pub name: String,
    /// What stands under it.
    pub caption: String,
    /// The drawing, as SVG.
    pub svg: String,
}

/// A part of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Block {
    /// The start of a section.
    Heading(String),
    /// A paragraph.
    Text(String),
    /// A list of short texts.
    List(Vec<String>),
    /// Numbers.
    Table(Table),
    /// A drawing.
    Figure(Figure),
    /// Text as it stands in a file.
    Verbatim(String),
}

/// A report.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Document {
    /// The title.
    pub title: String,
    /// Its parts in their order.
    pub blocks: Vec<Block>,
}

impl Document {
    /// Starts a section.
    pub fn heading(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Heading(text.into()));
    }

    /// Adds a paragraph.
    pub fn text(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Text(text.into()));
    }

    /// Adds a table, if it has rows.
    pub fn table(&mut self, header: &[&str], rows: Vec<Vec<String>>) {
        if !rows.is_empty() {
            let header = header.iter().map(|name| (*name).to_owned()).collect();
            self.blocks.push(Block::Table(Table { header, rows }));
        }
    }

    /// The figures.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.blocks
            .iter()
            .filter_map(|block| if let Block::Figure(figure) = block { Some(figure) } else { None })
    }

    /// The report as a page of its own; nothing is fetched from elsewhere.
    pub fn to_html(&self) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    h1 { (self.title) }
                    @for block in &self.blocks { (block_html(block)) }
                }
            }
        };
        page.into_string() + "\n"
    }

    /// The report as Markdown; figures are links to `NAME.svg` beside it.
    pub fn to_markdown(&self) -> String {
        let blocks = self.blocks.iter().map(|block| match block {
            Block::Heading(text) => format!("## {text}\n"),
            Block::Text(text) => format!("{text}\n"),
            Block::List(items) => items.iter().map(|item| format!("- {item}\n")).collect(),
            Block::Table(table) => table_markdown(table),
            Block::Figure(Figure { name, caption, .. }) => format!("![{caption}]({name}.svg)\n"),
            Block::Verbatim(text) => format!("```\n{}\n```\n", text.trim_end()),
        });
        std::iter::once(format!("# {}\n", self.title)).chain(blocks).collect::<Vec<_>>().join("\n")
    }
}

fn block_html(block: &Block) -> Markup {
    match block {
        Block::Heading(text) => html! { h2 { (text) } },
        Block::Text(text) => html! { p { (text) } },
        Block::List(items) => html! { ul { @for item in items { li { (item) } } } },
        Block::Table(Table { header, rows }) => html! {
            table {
                thead { tr { @for name in header { th { (name) } } } }
                tbody { @for row in rows { tr { @for cell in row { td { (cell) } } } } }
            }
        },
        // Drawings are made here, and what others named in them is escaped there.
        Block::Figure(Figure { caption, svg, .. }) => html! {
            figure { (PreEscaped(svg)) figcaption { (caption) } }
        },
        Block::Verbatim(text) => html! { pre { (text) } },
    }
}

fn table_markdown(Table { header, rows }: &Table) -> String {
    let line = |cells: &[String]| {
        let cells: Vec<String> =
            cells.iter().map(|cell| cell.replace('|', "\\|").replace('\n', " ")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let rule = format!("|{}\n", "---|".repeat(header.len()));
    line(header) + &rule + &rows.iter().map(|row| line(row)).collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_others_named_is_escaped() {
        let mut document = Document { title: "a < b".to_owned(), blocks: Vec::new() };
        document.heading("<script>");
        document.table(&["x|y"], vec![vec!["1 & 2|3".to_owned()]]);
        let html = document.to_html();
        assert!(html.contains("a &lt; b") && html.contains("&lt;script&gt;"), "{html}");
        assert!(html.contains("<td>1 &amp; 2|3</td>") && !html.contains("http"), "{html}");
        assert_eq!(document.to_markdown(), "# a < b\n\n## <script>\n\n| x\\|y |\n|---|\n| 1 & 2\\|3 |\n");
    }

    #[test]
    fn a_table_without_rows_is_left_out() {
        let mut document = Document::default();
        document.table(&["a"], Vec::new());
        assert!(document.blocks.is_empty());
    }
}
