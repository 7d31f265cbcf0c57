"""Models in other languages: the sorted equations, printed and solved there."""
