//! `realistic plan`: what a camera keeps and leaves out, why, and what that saves.

mod savings;

use crate::choice::{FilmChoice, FilmPlace, LensChoice, not_negative, set_parameters, warn};
use crate::failure::Failure;
use realistic::camera::{CameraError, Host, Level, Parameters, Raster, RealisticCamera};
use realistic::plan::choice::{Candidate, Verdict};
use realistic::plan::{Item, Plan};
use serde_json::{Value, json};
use std::io::Write as _;

/// What `plan` can be told.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    #[command(flatten)]
    place: FilmPlace,
    #[command(flatten)]
    film: FilmChoice,
    /// Pixels that 99.9 % of the rays may be off, for a faster model of the lens [default: 0, exact rays]
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true, value_parser = not_negative)]
    tolerance: Option<f64>,
    /// Another camera parameter, as `render --help` lists them; may be given again
    #[arg(long = "param", value_name = "NAME=VALUE")]
    parameters: Vec<String>,
    /// Write JSON
    #[arg(long)]
    json: bool,
}

/// Prints the plan, and what it saves as measured now.
///
/// # Errors
/// The camera cannot be built.
pub fn run(args: &Args) -> Result<(), Failure> {
    let order = Order::of(args)?;
    let camera = order.camera(true, order.tolerance(), &mut |level, message| {
        if level == Level::Warning {
            warn(message);
        }
    })?;
    let plan = camera.plan();
    let savings = savings::Savings::measure(&order)?;
    let text = if args.json {
        let mut value = as_json(plan);
        value["measured"] = savings.json();
        format!("{value:#}\n")
    } else {
        plan.to_string() + &savings.text()
    };
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}

/// A camera to be built in several ways.
struct Order {
    parameters: Parameters,
    host: Host,
}

impl Order {
    fn of(args: &Args) -> Result<Self, Failure> {
        let mut parameters = Parameters::default();
        args.lens.give(&mut parameters);
        args.place.give(&mut parameters);
        args.film.give(&mut parameters);
        parameters.tolerance = args.tolerance;
        set_parameters(&mut parameters, &args.parameters)?;
        let [xres, yres] = args.film.size;
        Ok(Self { parameters, host: Host::new(Raster { xres, yres }, None) })
    }

    /// The tolerance asked for, pixels.
    fn tolerance(&self) -> f64 {
        self.parameters.tolerance.unwrap_or(0.0)
    }

    fn camera(
        &self,
        leave_out: bool,
        tolerance: f64,
        log: &mut dyn FnMut(Level, &str),
    ) -> Result<RealisticCamera, Failure> {
        let parameters = Parameters { tolerance: Some(tolerance), ..self.parameters.clone() };
        let host = Host { leave_out, ..self.host.clone() };
        RealisticCamera::build(&parameters, &host, log).map_err(|error| match error {
            CameraError::Parameter(error) => error.into(),
            other => Failure::Other(other.to_string()),
        })
    }
}

fn as_json(plan: &Plan) -> Value {
    let items: Vec<Value> = plan
        .items()
        .iter()
        .map(|Item { what, kept, why, effect }| {
            json!({ "what": what, "kept": kept, "why": why, "effect": effect })
        })
        .collect();
    let choice = plan.choice().map(|choice| {
        let candidates: Vec<Value> = choice
            .candidates
            .iter()
            .map(|Candidate { tracing, cost, verdict }| {
                let errors = match verdict {
                    Verdict::Chosen(errors) | Verdict::Rejected(errors) => Some(errors),
                    Verdict::Excluded(_) | Verdict::Untried => None,
                };
                json!({
                    "model": tracing.to_string(),
                    "ordered_by_ns_a_ray": cost,
                    "chosen": matches!(verdict, Verdict::Chosen(_)),
                    "verdict": verdict.text(),
                    "error_999_pixels": errors.map(|errors| errors.pixels).filter(|pixels| pixels.is_finite()),
                    "rays": errors.map(|errors| errors.rays),
                    "mismatches": errors.map(|errors| errors.mismatches),
                    "light_error": errors.map(|errors| errors.light),
                })
            })
            .collect();
        json!({ "tolerance_pixels": choice.tolerance, "candidates": candidates })
    });
    json!({ "items": items, "choice": choice })
}
