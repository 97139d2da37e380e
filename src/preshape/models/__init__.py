"""Networks that predict grasp success, and how they are trained."""
