//! Pictures as pgfplots source: axes, data and texts that can be edited, in the font of a paper.
//!
//! Frames, names and explanations stand where they stand in SVG, at six pixels per millimetre. Coordinates are
//! those of the data. TeX computes with few figures: where the ends of an axis have three of them in common,
//! coordinates count from its lower end, and a comment says so.

use std::collections::BTreeSet;
use std::fmt::Write;

use plotters::style::RGBColor;

use super::axis::{Scale, TICK_SIZE, Tick, drawable};
use super::canvas::thinned;
use super::frame::PanelFrame;
use super::mark::{Mark, MarkShape};
use super::paint;
use super::palette::{BLACK, Pattern, Pen, WHITE};
use super::picture::{ColourCell, Layer, Picture, Point};
use super::surface::{Align, Drawn, Place, RenderError, Surface, Text, WIDTH};

const PIXELS: f64 = 6.0;

/// Coordinates further out than this many lengths of the axis are moved there: TeX's lengths end at 5.7 m.
const FAR: f64 = 20.0;

/// Part of the magnitude of an axis that its length has at least, for coordinates to be the data itself.
const SHORT: f64 = 1e-3;

struct TexSheet {
    text: String,
    height: f64,
    colours: BTreeSet<[u8; 3]>,
}

impl Picture {
    /// The picture as a document for pdfLaTeX, one page of the width of a column.
    ///
    /// # Errors
    /// None: writing to a string does not fail.
    pub(super) fn tex(&self) -> Result<String, RenderError> {
        let frames = self.frames();
        let mut sheet = TexSheet {
            text: String::new(),
            height: self.height(&frames),
            colours: BTreeSet::new(),
        };
        self.draw(&mut sheet, &frames)?;
        let (width, height) = (WIDTH / PIXELS, sheet.height / PIXELS);
        let page = format!(
            "% brakewave: the part from \\begin{{tikzpicture}} on stands in any paper that loads pgfplots.\n\
             \\documentclass{{article}}\n\\usepackage[paperwidth={width:.1}mm, paperheight={:.1}mm, \
             margin=0mm, nohead, nofoot]{{geometry}}\n\\usepackage{{pgfplots}}\n\\pgfplotsset{{compat=1.14}}\n\
             \\pagestyle{{empty}}\n\\begin{{document}}\n\\noindent\n",
            height + 1.0
        );
        let colours = sheet.colours.iter().map(|[r, g, b]| {
            format!("\\definecolor{{c{r:02x}{g:02x}{b:02x}}}{{RGB}}{{{r},{g},{b}}}%\n")
        });
        Ok(format!(
            "{page}{}\\begin{{tikzpicture}}[x=1mm, y=1mm, line join=round]\n\
             \\useasboundingbox (0,0) rectangle ({width:.1},{height:.1});\n{}\\end{{tikzpicture}}\n\\end{{document}}\n",
            colours.collect::<String>(),
            sheet.text
        ))
    }
}

impl Surface for TexSheet {
    fn line(&mut self, places: &[Place], pen: Pen) -> Drawn {
        let places: Vec<String> = places
            .iter()
            .map(|place| self.millimetres(*place))
            .collect();
        let pen = self.pen(pen);
        self.add(format_args!("\\path[{pen}] {};\n", places.join(" -- ")))
    }

    fn area(&mut self, from: Place, to: Place, colour: RGBColor) -> Drawn {
        let [from, to] = [from, to].map(|corner| self.millimetres(corner));
        let colour = self.colour(colour);
        self.add(format_args!("\\fill[{colour}] {from} rectangle {to};\n"))
    }

    fn polygon(&mut self, corners: &[Place], colour: RGBColor) -> Drawn {
        let corners = corners.iter().map(|corner| self.millimetres(*corner));
        let corners = corners.collect::<Vec<_>>().join(" -- ");
        let colour = self.colour(colour);
        self.add(format_args!("\\fill[{colour}] {corners} -- cycle;\n"))
    }

    fn mark(&mut self, place: Place, mark: Mark) -> Drawn {
        let (mark, place) = (self.look(mark), self.millimetres(place));
        self.add(format_args!(
            "\\path plot[{mark}] coordinates {{{place}}};\n"
        ))
    }

    fn text(&mut self, text: Text<'_>) -> Drawn {
        let side = match text.align {
            Align::Left => " west",
            Align::Right => " east",
            Align::Middle | Align::Upward => "",
        };
        let font = if text.size > TICK_SIZE {
            "footnotesize"
        } else {
            "scriptsize"
        };
        let (place, colour) = (self.millimetres(text.place), self.colour(text.colour));
        self.add(format_args!(
            "\\node[inner sep=0pt, anchor=base{side}, font=\\{font}, text={colour}] at {place} {{{}}};\n",
            escaped(text.text)
        ))
    }
}

impl paint::Sheet for TexSheet {
    /// A frame with its axes and what is drawn in it, then what stands outside of it.
    fn panel(&mut self, frame: &PanelFrame, layers: &[Layer]) -> Drawn {
        let (width, height) = (frame.to.0 - frame.from.0, frame.to.1 - frame.from.1);
        let (x, y) = (Coordinates::of(&frame.x), Coordinates::of(&frame.y));
        for (name, axis) in [("x", &x), ("y", &y)] {
            if axis.base != 0.0 {
                self.add(format_args!(
                    "% {name}: {:?} is to be added to coordinates\n",
                    axis.base
                ))?;
            }
        }
        let (left, low) = (frame.from.0 / PIXELS, (self.height - frame.to.1) / PIXELS);
        let caption = if frame.labelled_below {
            &*frame.x.caption
        } else {
            ""
        };
        self.add(format_args!(
            "\\begin{{axis}}[at={{({left:.2}mm,{low:.2}mm)}}, anchor=south west, scale only axis,\n  \
             width={:.2}mm, height={:.2}mm, axis on top, scaled ticks=false, minor tick num=0,\n  \
             every tick/.style={{black, line width=0.22mm}}, ticklabel style={{font=\\scriptsize}}, label style={{font=\\footnotesize}},\n{}{}]\n",
            width / PIXELS,
            height / PIXELS,
            x.options("x", frame.labelled_below, caption),
            y.options("y", true, &frame.y.caption)
        ))?;
        for layer in layers {
            self.inside(frame, [&x, &y], layer)?;
        }
        self.add(format_args!("\\end{{axis}}\n"))?;
        let mut texts = layers.iter();
        texts.try_for_each(|layer| frame.outside(self, layers, layer))
    }

    fn border(&mut self, _: &PanelFrame) -> Drawn {
        Ok(())
    }
}

impl TexSheet {
    /// A piece of the file.
    fn add(&mut self, piece: std::fmt::Arguments) -> Drawn {
        // writing to a string does not fail
        let _ = self.text.write_fmt(piece);
        Ok(())
    }

    /// A place in millimetres from the lower left corner.
    fn millimetres(&self, (x, y): Place) -> String {
        format!("({:.2},{:.2})", x / PIXELS, (self.height - y) / PIXELS)
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

    fn look(&mut self, mark: Mark) -> String {
        let (name, filled) = match mark.shape {
            MarkShape::Disc | MarkShape::Dot => ("*", true),
            MarkShape::Circle => ("*", false),
            MarkShape::Square => ("square*", true),
            MarkShape::OpenSquare => ("square*", false),
            MarkShape::Up => ("triangle*", true),
            MarkShape::OpenDown => ("triangle*", false),
            MarkShape::Diamond => ("diamond*", true),
            MarkShape::OpenDiamond => ("diamond*", false),
            MarkShape::Star => ("star", false),
            MarkShape::Plus => ("+", false),
            MarkShape::Cross => ("x", false),
            MarkShape::Tick => ("|", false),
        };
        let colour = self.colour(mark.colour);
        let (draw, fill) = if filled {
            ("white", &*colour)
        } else {
            (&*colour, "white")
        };
        let turn = if mark.shape == MarkShape::OpenDown {
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

    /// The data in a frame, in the coordinates of its axes.
    fn inside(&mut self, frame: &PanelFrame, [x, y]: [&Coordinates; 2], layer: &Layer) -> Drawn {
        let has = |point: &&Point| x.has(point.0) && y.has(point.1);
        let joined = |points: &[Point], frame: &str, between: &str| -> String {
            let at = |point: &Point| format!("({frame}{},{})", x.at(point.0), y.at(point.1));
            points.iter().map(at).collect::<Vec<_>>().join(between)
        };
        match layer {
            Layer::Line(points, pen) => {
                let pen = self.pen(*pen);
                for stretch in points.split(|point| !has(&point)) {
                    if stretch.len() > 1 {
                        let place = |point: &Point| frame.at(x.part(point.0), y.part(point.1));
                        let data = joined(&thinned(stretch, place), "", " ");
                        self.add(format_args!("\\addplot[{pen}] coordinates {{{data}}};\n"))?;
                    }
                }
            }
            Layer::Across(value, pen) => {
                let (pen, up) = (self.pen(*pen), y.part(*value));
                self.add(format_args!(
                    "\\draw[{pen}] (rel axis cs:0,{up:.5}) -- (rel axis cs:1,{up:.5});\n"
                ))?;
            }
            Layer::Upright(value, pen) => {
                let (pen, across) = (self.pen(*pen), x.part(*value));
                self.add(format_args!(
                    "\\draw[{pen}] (rel axis cs:{across:.5},0) -- (rel axis cs:{across:.5},1);\n"
                ))?;
            }
            Layer::Marks(points, mark) => {
                let mark = self.look(*mark);
                let drawn: Vec<Point> = points.iter().filter(has).copied().collect();
                if !drawn.is_empty() {
                    let data = joined(&drawn, "", " ");
                    self.add(format_args!("\\addplot[{mark}] coordinates {{{data}}};\n"))?;
                }
            }
            Layer::Area(corners, colour) => {
                let colour = self.colour(*colour);
                let drawn: Vec<Point> = corners.iter().filter(has).copied().collect();
                if !drawn.is_empty() {
                    let corners = joined(&drawn, "axis cs:", " -- ");
                    self.add(format_args!("\\fill[{colour}] {corners} -- cycle;\n"))?;
                }
            }
            Layer::Cells(cells) => {
                for ColourCell { from, to, colour } in cells {
                    let corners = [x.part(from.0), y.part(from.1), x.part(to.0), y.part(to.1)];
                    if corners.iter().any(|corner| corner.is_nan()) {
                        continue;
                    }
                    let colour = self.colour(*colour);
                    let [left, low, right, high] = corners.map(|part| part.clamp(0.0, 1.0));
                    self.add(format_args!(
                        "\\fill[{colour}] (rel axis cs:{left:.5},{low:.5}) rectangle (rel axis cs:{right:.5},{high:.5});\n"
                    ))?;
                }
            }
            Layer::Names(_) | Layer::Headings(_) | Layer::Bar { .. } | Layer::Remark(_) => {}
        }
        Ok(())
    }
}

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

/// Signs that the fonts of TeX have in formulas only, each followed by its name there.
const SIGNS: &str = r"
    α \alpha  β \beta  γ \gamma  δ \delta  ε \varepsilon  ζ \zeta  η \eta  θ \theta  κ \kappa
    λ \lambda  μ \mu  ν \nu  ξ \xi  π \pi  ρ \rho  σ \sigma  τ \tau  φ \varphi  χ \chi  ψ \psi
    ω \omega  Γ \Gamma  Δ \Delta  Θ \Theta  Λ \Lambda  Ξ \Xi  Π \Pi  Σ \Sigma  Φ \Phi  Ψ \Psi
    Ω \Omega  − -  × \times  ± \pm  · \cdot  → \to  ≤ \le  ≥ \ge  ≠ \ne  √ \surd  ∞ \infty  ′ '
    ″ ''  … \ldots  ∂ \partial  < <  > >  | |  ⁻ ^-  ½ \frac12  µ \mu  ° ^\circ  \ \backslash
    ⁿ ^n  ≈ \approx
";

/// A text for TeX: signs that it takes for its own, and those that its fonts have in formulas only.
fn escaped(text: &str) -> String {
    const FIGURES: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";
    let mut out = String::new();
    let mut letters = text.chars().peekable();
    while let Some(c) = letters.next() {
        let mut words = SIGNS.split_whitespace();
        let mut pairs = std::iter::from_fn(|| Some((words.next()?, words.next()?)));
        let sign = pairs
            .find(|(sign, _)| sign.starts_with(c))
            .map(|(_, tex)| tex);
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
