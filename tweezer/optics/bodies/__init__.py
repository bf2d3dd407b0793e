"""Light on a body of any shape: its T-matrix, and the exact force and torque."""
