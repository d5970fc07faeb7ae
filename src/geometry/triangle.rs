//! Ray–triangle tests (contract; implemented by the geometry work).
