"""Power: what storages hold, how ports are joined, and what stays constant."""
