"""A Franka Panda in a MuJoCo model with robosuite's names: stepping it under the passive controller, and what it reaches."""
