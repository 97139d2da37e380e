"""Tables, figures and reports from result tables."""
