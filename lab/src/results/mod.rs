//! Summaries of measurements: quantiles, slopes and Pareto fronts, and tables as comma-separated
//! files.

pub mod statistics;
pub mod table;
