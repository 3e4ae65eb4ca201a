//! Scenario files in, results out: what every front end of asperity shares.
