"""One frame of the predictor-corrector: apart, in contact, or from a global start."""
