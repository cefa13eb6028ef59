//! Pictures as pgfplots source: axes, data and texts that can be edited, in the font of a paper.
//!
//! Frames, names and explanations stand where they stand in SVG, at six pixels per millimetre. Coordinates are
//! those of the data. TeX computes with few figures: where the ends of an axis have three of them in common,
//! coordinates count from its lower end, and a comment says so.

use std::collections::BTreeSet;
use std::fmt::Write;

use plotters::style::RGBColor;

use super::axis::{Scale, Tick, drawable};
use super::canvas::{Place, WIDTH, thinned};
use super::frame::Frame;
use super::legend::Key;
use super::palette::{BLACK, GREY, Pattern, Pen, WHITE};
use super::placement::written;
use super::{Layer, Mark, Picture, Point, Shape};

/// Pixels per millimetre.
const PIXELS: f64 = 6.0;

/// Coordinates further out than this many lengths of the axis are moved there: TeX's lengths end at 5.7 m.
const FAR: f64 = 20.0;

/// Part of the magnitude of an axis that its length has at least, for coordinates to be the data itself.
const SHORT: f64 = 1e-3;

/// A file being written.
struct Sheet {
    text: String,
    /// Height in pixels.
    height: f64,
    colours: BTreeSet<[u8; 3]>,
}

impl Picture {
    /// The picture as a document for pdfLaTeX, one page of the width of a column.
    pub(super) fn tex(&self) -> String {
        let (frames, bottom) = self.frames();
        let height = (bottom + self.legend.height()).ceil();
        let mut sheet = Sheet {
            text: String::new(),
            height,
            colours: BTreeSet::new(),
        };
        for (line, base, style) in [
            (&self.title, 27.0, "font=\\footnotesize"),
            (&self.subtitle, self.top() - 12.0, "font=\\scriptsize, gray"),
        ] {
            if let Some(line) = line {
                let style = format!("anchor=base, {style}");
                sheet.node((0.5 * WIDTH, base), &style, line);
            }
        }
        for (frame, panel) in frames.iter().zip(&self.panels) {
            sheet.panel(frame, &panel.layers);
        }
        for item in self.legend.items().0 {
            sheet.explanation(item.key, item.at(bottom), item.text);
        }
        let page = format!(
            "% brakewave: the part from \\begin{{tikzpicture}} on stands in any paper that loads pgfplots.\n\
             \\documentclass{{article}}\n\\usepackage[paperwidth={:.1}mm, paperheight={:.1}mm, \
             margin=0mm, nohead, nofoot]{{geometry}}\n\\usepackage{{pgfplots}}\n\\pgfplotsset{{compat=1.14}}\n\
             \\pagestyle{{empty}}\n\\begin{{document}}\n\\noindent\n",
            WIDTH / PIXELS,
            height / PIXELS + 1.0
        );
        let colours = sheet.colours.iter().map(|[r, g, b]| {
            format!("\\definecolor{{c{r:02x}{g:02x}{b:02x}}}{{RGB}}{{{r},{g},{b}}}%\n")
        });
        format!(
            "{page}{}\\begin{{tikzpicture}}[x=1mm, y=1mm, line join=round]\n\
             \\useasboundingbox (0,0) rectangle ({:.1},{:.1});\n{}\\end{{tikzpicture}}\n\\end{{document}}\n",
            colours.collect::<String>(),
            WIDTH / PIXELS,
            height / PIXELS,
            sheet.text
        )
    }
}

impl Sheet {
    /// A piece of the file. Writing to a string does not fail.
    fn add(&mut self, piece: std::fmt::Arguments) {
        let _ = self.text.write_fmt(piece);
    }

    /// A place in millimetres from the lower left corner.
    fn millimetres(&self, (x, y): Place) -> String {
        format!("({:.2},{:.2})", x / PIXELS, (self.height - y) / PIXELS)
    }

    fn node(&mut self, place: Place, style: &str, text: &str) {
        let at = self.millimetres(place);
        self.add(format_args!(
            "\\node[inner sep=0pt, {style}] at {at} {{{}}};\n",
            escaped(text)
        ));
    }

    fn colour(&mut self, colour: RGBColor) -> String {
        let RGBColor(r, g, b) = colour;
        match colour {
            BLACK => return "black".into(),
            WHITE => return "white".into(),
            _ => self.colours.insert([r, g, b]),
        };
        format!("c{r:02x}{g:02x}{b:02x}")
    }

    fn pen(&mut self, pen: Pen) -> String {
        let pattern = match pen.pattern {
            Pattern::Solid => "",
            Pattern::Dashed => ", dashed",
            Pattern::Dotted => ", densely dotted",
        };
        let (colour, width) = (self.colour(pen.colour), pen.width / PIXELS);
        format!("draw={colour}, line width={width:.2}mm{pattern}")
    }

    fn mark(&mut self, mark: Mark) -> String {
        let (name, filled) = match mark.shape {
            Shape::Disc => ("*", true),
            Shape::Circle => ("*", false),
            Shape::Square => ("square*", true),
            Shape::OpenSquare => ("square*", false),
            Shape::Up => ("triangle*", true),
            Shape::OpenDown => ("triangle*", false),
            Shape::Diamond => ("diamond*", true),
            Shape::OpenDiamond => ("diamond*", false),
            Shape::Star => ("star", false),
            Shape::Plus => ("+", false),
            Shape::Cross => ("x", false),
            Shape::Tick => ("|", false),
        };
        let colour = self.colour(mark.colour);
        let (draw, fill) = if filled {
            ("white", &*colour)
        } else {
            (&*colour, "white")
        };
        let turn = if mark.shape == Shape::OpenDown {
            ", rotate=180"
        } else {
            ""
        };
        let (size, width) = (mark.size / PIXELS, if filled { 0.15 } else { 0.27 });
        format!(
            "only marks, mark={name}, mark size={size:.2}mm, \
             mark options={{draw={draw}, fill={fill}, line width={width}mm{turn}}}"
        )
    }

    /// A frame with its axes and what is drawn in it, then what stands outside of it.
    fn panel(&mut self, frame: &Frame, layers: &[Layer]) {
        let (width, height) = (frame.to.0 - frame.from.0, frame.to.1 - frame.from.1);
        let (x, y) = (Coordinates::of(&frame.x), Coordinates::of(&frame.y));
        for (name, axis) in [("x", &x), ("y", &y)] {
            if axis.base != 0.0 {
                self.add(format_args!(
                    "% {name}: {:?} is to be added to coordinates\n",
                    axis.base
                ));
            }
        }
        let (left, low) = (frame.from.0 / PIXELS, (self.height - frame.to.1) / PIXELS);
        self.add(format_args!(
            "\\begin{{axis}}[at={{({left:.2}mm,{low:.2}mm)}}, anchor=south west, scale only axis,\n  \
             width={:.2}mm, height={:.2}mm, axis on top, scaled ticks=false, minor tick num=0,\n  \
             every tick/.style={{black, line width=0.22mm}}, ticklabel style={{font=\\scriptsize}}, label style={{font=\\footnotesize}},\n",
            width / PIXELS,
            height / PIXELS
        ));
        let caption = if frame.labelled_below {
            &*frame.x.caption
        } else {
            ""
        };
        self.add(format_args!(
            "{}",
            x.options("x", frame.labelled_below, caption)
        ));
        self.add(format_args!(
            "{}]\n",
            y.options("y", true, &frame.y.caption)
        ));
        for layer in layers {
            self.inside(frame, [&x, &y], layer);
        }
        self.add(format_args!("\\end{{axis}}\n"));
        for layer in layers {
            self.over(frame, layers, layer);
        }
    }

    fn inside(&mut self, frame: &Frame, [x, y]: [&Coordinates; 2], layer: &Layer) {
        let shown = |points: &[Point]| -> String {
            let points = points
                .iter()
                .map(|point| format!("({},{})", x.at(point.0), y.at(point.1)));
            points.collect::<Vec<_>>().join(" ")
        };
        match layer {
            Layer::Line(points, pen) => {
                let pen = self.pen(*pen);
                for stretch in points.split(|point| !(x.has(point.0) && y.has(point.1))) {
                    if stretch.len() > 1 {
                        let place = |point: &Point| frame.at(x.part(point.0), y.part(point.1));
                        let data = shown(&thinned(stretch, place));
                        self.add(format_args!("\\addplot[{pen}] coordinates {{{data}}};\n"));
                    }
                }
            }
            Layer::Across(value, pen) => {
                let (pen, up) = (self.pen(*pen), y.part(*value));
                self.add(format_args!(
                    "\\draw[{pen}] (rel axis cs:0,{up:.5}) -- (rel axis cs:1,{up:.5});\n"
                ));
            }
            Layer::Upright(value, pen) => {
                let (pen, across) = (self.pen(*pen), x.part(*value));
                self.add(format_args!(
                    "\\draw[{pen}] (rel axis cs:{across:.5},0) -- (rel axis cs:{across:.5},1);\n"
                ));
            }
            Layer::Marks(points, mark) => {
                let mark = self.mark(*mark);
                let drawn = points
                    .iter()
                    .filter(|point| x.has(point.0) && y.has(point.1));
                let drawn: Vec<Point> = drawn.copied().collect();
                if !drawn.is_empty() {
                    self.add(format_args!(
                        "\\addplot[{mark}] coordinates {{{}}};\n",
                        shown(&drawn)
                    ));
                }
            }
            Layer::Area(corners, colour) => {
                let colour = self.colour(*colour);
                let drawn = corners
                    .iter()
                    .filter(|point| x.has(point.0) && y.has(point.1));
                let corners =
                    drawn.map(|point| format!("(axis cs:{},{})", x.at(point.0), y.at(point.1)));
                let corners: Vec<String> = corners.collect();
                if !corners.is_empty() {
                    self.add(format_args!(
                        "\\fill[{colour}] {} -- cycle;\n",
                        corners.join(" -- ")
                    ));
                }
            }
            Layer::Cells(cells) => {
                for cell in cells {
                    let corners = [
                        x.part(cell.from.0),
                        y.part(cell.from.1),
                        x.part(cell.to.0),
                        y.part(cell.to.1),
                    ];
                    if corners.iter().any(|corner| corner.is_nan()) {
                        continue;
                    }
                    let colour = self.colour(cell.colour);
                    let [left, low, right, high] = corners.map(|part| part.clamp(0.0, 1.0));
                    self.add(format_args!(
                        "\\fill[{colour}] (rel axis cs:{left:.5},{low:.5}) rectangle (rel axis cs:{right:.5},{high:.5});\n"
                    ));
                }
            }
            Layer::Names(_) | Layer::Headings(_) | Layer::Bar { .. } | Layer::Remark(_) => {}
        }
    }

    /// Texts, which the frame does not clip.
    fn over(&mut self, frame: &Frame, layers: &[Layer], layer: &Layer) {
        let small = "font=\\scriptsize";
        match layer {
            Layer::Names(names) => {
                for (place, text) in written(frame, layers, names) {
                    self.node(place, small, text);
                }
            }
            Layer::Headings(headings) => {
                for (place, text) in headings.iter().filter_map(|heading| frame.heading(heading)) {
                    self.node(place, &format!("anchor=base, {small}"), text);
                }
            }
            Layer::Bar { foot, head, text } => {
                let right = frame.to.0 + 12.0;
                let [foot, head] =
                    [*foot, *head].map(|end| (right, frame.at(1.0, frame.y.part(end)).1));
                let [low, high] = [foot, head].map(|end| self.millimetres(end));
                self.add(format_args!(
                    "\\draw[|-|, line width=0.27mm] {low} -- {high};\n"
                ));
                let middle = (right + 8.0, 0.5 * (foot.1 + head.1));
                for (line, anchor) in text.iter().zip(["south west", "north west"]) {
                    self.node(middle, &format!("anchor={anchor}, {small}"), line);
                }
            }
            Layer::Remark(text) => {
                let grey = self.colour(GREY);
                self.node(frame.at(0.5, 0.5), &format!("{small}, text={grey}"), text);
            }
            _ => {}
        }
    }

    /// An entry of the legend: its sign, and the text on its base line.
    fn explanation(&mut self, key: Option<Key>, (left, base): Place, text: &str) {
        let middle = base - 5.0;
        let at = |x: f64, y: f64| (left + x, middle + y);
        match key {
            Some(Key::Line(pen)) => {
                let pen = self.pen(pen);
                let (from, to) = (
                    self.millimetres(at(0.0, 0.0)),
                    self.millimetres(at(26.0, 0.0)),
                );
                self.add(format_args!("\\path[{pen}] {from} -- {to};\n"));
            }
            Some(Key::Mark(mark)) => {
                let (mark, place) = (self.mark(mark), self.millimetres(at(7.0, 0.0)));
                self.add(format_args!(
                    "\\path plot[{mark}] coordinates {{{place}}};\n"
                ));
            }
            Some(Key::Area(colour)) => {
                let colour = self.colour(colour);
                let (from, to) = (
                    self.millimetres(at(0.0, 6.0)),
                    self.millimetres(at(18.0, -6.0)),
                );
                self.add(format_args!(
                    "\\filldraw[fill={colour}, line width=0.13mm] {from} rectangle {to};\n"
                ));
            }
            None => {}
        }
        let place = (left + key.map_or(0.0, Key::width), base);
        self.node(place, "anchor=base west, font=\\scriptsize", text);
    }
}

/// Coordinates along an axis.
struct Coordinates<'a> {
    scale: &'a Scale,
    /// What is subtracted from the data.
    base: f64,
}

impl<'a> Coordinates<'a> {
    fn of(scale: &'a Scale) -> Coordinates<'a> {
        let magnitude = scale.low.abs().max(scale.high.abs());
        let short = !scale.logarithmic && scale.high - scale.low < SHORT * magnitude;
        Coordinates {
            scale,
            base: if short { scale.low } else { 0.0 },
        }
    }

    /// Whether a value has a coordinate.
    fn has(&self, value: f64) -> bool {
        drawable(value) && (!self.scale.logarithmic || value > 0.0)
    }

    fn part(&self, value: f64) -> f64 {
        self.scale.part(value).clamp(-FAR, FAR)
    }

    /// A coordinate with nine figures, eight of them below the length of the axis.
    fn at(&self, value: f64) -> String {
        let Scale {
            low,
            high,
            logarithmic,
            ..
        } = *self.scale;
        let part = self.scale.part(value);
        let value = match part.clamp(-FAR, FAR) {
            within if within == part => value,
            moved if logarithmic => 10f64.powf(low + moved * (high - low)),
            moved => low + moved * (high - low),
        };
        let text = format!("{:.8e}", value - self.base);
        text.parse()
            .map_or(text, |rounded: f64| format!("{rounded:e}"))
    }

    /// The options of the axis of this name.
    fn options(&self, name: &str, labelled: bool, caption: &str) -> String {
        let Scale {
            low,
            high,
            logarithmic,
            ticks,
            ..
        } = self.scale;
        let [low, high] = [*low, *high].map(|end| match logarithmic {
            true => format!("{:e}", 10f64.powf(end)),
            false => self.at(end),
        });
        let mode = if *logarithmic { "log" } else { "linear" };
        let list = |cell: &dyn Fn(&Tick) -> String| {
            let cells: Vec<String> = ticks.iter().map(cell).collect();
            cells.join(",")
        };
        let values = match ticks.is_empty() {
            true => "\\empty".to_owned(),
            false => format!("{{{}}}", list(&|tick| self.at(tick.value))),
        };
        let texts = list(&|tick| match labelled {
            true => format!("{{{}}}", escaped(&tick.text)),
            false => "{}".to_owned(),
        });
        format!(
            "  {name}mode={mode}, {name}min={low}, {name}max={high}, {name}tick={values},\n  \
             {name}ticklabels={{{texts}}}, {name}label={{{}}},\n",
            escaped(caption)
        )
    }
}

/// A text for TeX: signs that it takes for its own, and those that its fonts have in formulas only.
fn escaped(text: &str) -> String {
    const SIGNS: [(char, &str); 55] = [
        ('α', "\\alpha"),
        ('β', "\\beta"),
        ('γ', "\\gamma"),
        ('δ', "\\delta"),
        ('ε', "\\varepsilon"),
        ('ζ', "\\zeta"),
        ('η', "\\eta"),
        ('θ', "\\theta"),
        ('κ', "\\kappa"),
        ('λ', "\\lambda"),
        ('μ', "\\mu"),
        ('ν', "\\nu"),
        ('ξ', "\\xi"),
        ('π', "\\pi"),
        ('ρ', "\\rho"),
        ('σ', "\\sigma"),
        ('τ', "\\tau"),
        ('φ', "\\varphi"),
        ('χ', "\\chi"),
        ('ψ', "\\psi"),
        ('ω', "\\omega"),
        ('Γ', "\\Gamma"),
        ('Δ', "\\Delta"),
        ('Θ', "\\Theta"),
        ('Λ', "\\Lambda"),
        ('Ξ', "\\Xi"),
        ('Π', "\\Pi"),
        ('Σ', "\\Sigma"),
        ('Φ', "\\Phi"),
        ('Ψ', "\\Psi"),
        ('Ω', "\\Omega"),
        ('−', "-"),
        ('×', "\\times"),
        ('±', "\\pm"),
        ('·', "\\cdot"),
        ('→', "\\to"),
        ('≤', "\\le"),
        ('≥', "\\ge"),
        ('≠', "\\ne"),
        ('√', "\\surd"),
        ('∞', "\\infty"),
        ('′', "'"),
        ('″', "''"),
        ('…', "\\ldots"),
        ('∂', "\\partial"),
        ('<', "<"),
        ('>', ">"),
        ('|', "|"),
        ('⁻', "^-"),
        ('½', "\\frac12"),
        ('µ', "\\mu"),
        ('°', "^\\circ"),
        ('\\', "\\backslash"),
        ('ⁿ', "^n"),
        ('≈', "\\approx"),
    ];
    const FIGURES: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";
    let mut out = String::new();
    let mut letters = text.chars().peekable();
    while let Some(c) = letters.next() {
        let sign = SIGNS
            .iter()
            .find(|(sign, _)| *sign == c)
            .map(|(_, tex)| *tex);
        let accent = letters.next_if(|c| matches!(c, '\u{300}'..='\u{36f}'));
        let accent = accent.map(|accent| match accent {
            '\u{302}' => "\\hat",
            '\u{308}' => "\\ddot",
            _ => "\\dot",
        });
        let figure = FIGURES.chars().position(|figure| figure == c);
        let _ = match (sign, accent, figure, c) {
            (Some(sign), Some(accent), ..) => write!(out, "${accent}{{{sign}}}$"),
            (None, Some(accent), ..) => write!(out, "${accent}{{{c}}}$"),
            (Some(sign), ..) => write!(out, "${{}}{sign}$"),
            (_, _, Some(figure), _) => write!(out, "$^{figure}$"),
            (.., '{' | '}' | '#' | '$' | '%' | '&' | '_') => write!(out, "\\{c}"),
            (.., '^' | '~') => write!(out, "\\{c}{{}}"),
            (.., '–') => write!(out, "--"),
            (.., c) if c <= '\u{17f}' && !c.is_control() => write!(out, "{c}"),
            _ => write!(out, "?"),
        };
    }
    out
}
