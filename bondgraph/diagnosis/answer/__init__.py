"""The answer: findings, verdict, sentences, and what shows them."""
