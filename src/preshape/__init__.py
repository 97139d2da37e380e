"""Multi-fingered grasp planning as probabilistic inference in a learned network (Lu et al.)."""

__version__ = "0.1.0"
