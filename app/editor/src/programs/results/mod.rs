//! The results of a program: the sheet that is made from records, its table and its plot.

mod curves;
pub mod plot;
pub mod sheet;
pub mod table;
