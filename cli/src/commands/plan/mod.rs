//! `realistic plan`: the parts of the lens model that a camera keeps and leaves out, the reasons for this, and the
//! time saved.

mod order;
mod savings;

pub use order::Args;

use crate::console::warn;
use crate::failure::Failure;
use order::CameraOrder;
use realistic_camera::Level;
use realistic_camera::plan::choice::{Candidate, Verdict};
use realistic_camera::plan::{Entry, Item, Plan};
use serde_json::{Value, json};
use std::io::Write as _;

/// Prints the plan and the savings, which are measured now.
///
/// # Errors
/// The camera cannot be built.
pub fn run(args: &Args) -> Result<(), Failure> {
    let order = CameraOrder::of(args)?;
    let camera = order.camera(&mut |level, message| {
        if level == Level::Warning {
            warn(message);
        }
    })?;
    let plan = camera.plan();
    let savings = savings::Savings::measure(&order, &plan)?;
    let text = if args.json {
        let mut value = as_json(&plan);
        let facts = camera.facts().expect("a camera of the model \"lens\" has one");
        value["name"] = json!(facts.lens.name);
        value["wavelength"] = json!(facts.lens.wavelength);
        value["focal_length_mm"] = json!(facts.focal_length());
        value["fnumber"] = json!(facts.fnumber());
        value["film_diagonal"] = json!(facts.film.diagonal());
        value["film_distance"] = json!(facts.film_distance);
        value["focus_distance_mm"] = json!(facts.focus_distance_mm);
        value["measured"] = savings.json();
        format!("{value:#}\n")
    } else {
        plan.to_string() + &savings.text()
    };
    Ok(std::io::stdout().write_all(text.as_bytes())?)
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
        let chosen = Entry::ALL.map(|entry| choice.chosen(entry).0.tracing);
        let candidates: Vec<Value> = choice
            .candidates
            .iter()
            .map(|Candidate { tracing, costs, verdict }| {
                let errors = match verdict {
                    Verdict::Within(errors) | Verdict::WrongLight(errors) => Some(errors),
                    Verdict::TooFarOff(_) | Verdict::Excluded(_) | Verdict::Untried => None,
                };
                let [one, many] = chosen.map(|chosen| chosen == *tracing);
                json!({
                    "model": tracing.to_string(),
                    "ordered_by_ns_per_ray": { "one_by_one": costs[0], "in_batches": costs[1] },
                    "chosen": { "one_by_one": one, "in_batches": many },
                    "verdict": verdict.text(),
                    "error_999_pixels": errors.map(|errors| errors.pixels),
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
