//! The window, driven without a display: the real app through its accessibility tree, and its worker.

mod compare;
mod controls;
mod crash;
mod driver;
mod files;
mod navigation;
mod same_picture;
mod trade;
mod views;
mod wild;
mod worker;
