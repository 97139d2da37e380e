"""Networks that learn p(success | theta, view), and their Lightning module."""
