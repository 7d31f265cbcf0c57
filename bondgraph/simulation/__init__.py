"""Simulation: models driven by recorded inputs."""
