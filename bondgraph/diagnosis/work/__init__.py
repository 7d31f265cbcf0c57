"""Where the work is done, and the journal that lets it go on after a stop."""
