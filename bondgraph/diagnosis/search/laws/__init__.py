"""Laws one by one: the fits of a round, and each law in the form that data want."""
