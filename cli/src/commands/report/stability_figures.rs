//! The figures of stability: cases by their condition number.

use super::figures::{Figure, SHAPES, Section};
use crate::plots::PALETTE;
use crate::plots::chart::{Chart, Mark, Series};
use realistic_lab::condition::Norm;
use realistic_lab::stability::{self, BOUND};
use realistic_lab::suite::{Results, stability_table};
use std::collections::BTreeSet;

const STABILITY: &str = "Extreme cases with known answers: a mark is a case, its error over what a perfect tracer must \
    expect from the condition number of the case and its own rounding unit. A figure of order one, whatever the \
    condition, is a backward stable tracer; what is below 1e-6, or exact, stands there. The dotted lines are the \
    bounds that the tests hold. A kernel's points are as good as the size of the surface that they lie on, those of a walk as \
    good as their own distance from the vertex: the condition numbers are reckoned so. Kernels that give the same bits \
    are drawn once. The table has the worst of each group, the CSV every case.";

/// Ratios below this are shown as this.
const EXACT: f64 = 1e-6;

/// One chart of cases: whose, and the bounds that are drawn.
fn stability_chart(
    results: &Results,
    title: &str,
    shown: &[&'static str],
    levels: Vec<(f64, String)>,
) -> Chart {
    // Marks that would cover each other all but for a pixel are drawn once.
    const GRAIN: f64 = 20.0;
    let mut drawn = BTreeSet::new();
    let series = shown.iter().enumerate().map(|(number, &kernel)| Series {
        name: kernel.to_owned(),
        color: PALETTE[number % PALETTE.len()],
        shape: SHAPES[number % SHAPES.len()],
        line: None,
        marks: results
            .stability
            .iter()
            // What is judged by rays without number has no condition number; it is in the table.
            .filter(|case| case.kernel == kernel && case.condition > 0.0)
            .map(|case| [case.condition, case.ratio.max(EXACT)])
            .filter(|at| drawn.insert((number, at.map(|x| (x.log10() * GRAIN).round() as i64))))
            .map(|at| Mark { at, reach: None, name: None, on_front: false })
            .collect(),
    });
    Chart {
        title: title.to_owned(),
        cost: "condition number of the ray map",
        error: "error / (condition x epsilon)",
        levels,
        series: series.collect(),
    }
}

/// The section with its three charts.
pub fn section(results: &Results) -> Section {
    let kernels = stability::kernels();
    let named = |norm: Norm| -> Vec<&'static str> {
        kernels.iter().filter(|k| k.norm == norm && k.like == k.name).map(|k| k.name).collect()
    };
    let (walks, compiled) = (named(Norm::Own), named(Norm::Surface));
    let mut levels = vec![(BOUND, format!("bound, {BOUND}"))];
    let looser = kernels.iter().filter(|k| k.norm == Norm::Own && k.bound > BOUND);
    levels.extend(looser.map(|k| (k.bound, format!("bound of {}, {}", k.name, k.bound))));
    let compiled_kernels = kernels.iter().filter(|k| k.norm == Norm::Surface);
    let bound = compiled_kernels.map(|k| k.bound).fold(f64::INFINITY, f64::min);
    let bounds = vec![(bound, format!("bound, {bound}"))];
    let charts = [
        ("walks", stability_chart(results, "walks", &walks, levels)),
        ("kernels", stability_chart(results, "compiled kernels", &compiled, bounds)),
        (
            "design",
            stability_chart(
                results,
                "focal length, pupil and focus",
                &["first order", "focus"],
                vec![(BOUND, format!("bound, {BOUND}"))],
            ),
        ),
    ];
    Section {
        anchor: "stability",
        title: "Stability on stiff and extreme cases",
        text: STABILITY,
        table: "stability",
        figures: charts
            .into_iter()
            .map(|(name, chart)| Figure { file: format!("stability-{name}"), chart })
            .collect(),
        summary: Some(stability_table(&results.stability_by_group())),
    }
}
