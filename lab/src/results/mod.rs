//! Summaries of measurements: quantiles, slopes, Pareto fronts, and tables that are saved as comma-separated files.

pub mod statistics;
pub mod table;
