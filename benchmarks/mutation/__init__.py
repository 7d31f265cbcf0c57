"""Mutation testing: whether the tests of what is trusted are able to fail."""
