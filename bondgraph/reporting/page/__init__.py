"""The parts of the report page: what each section shows, before it is HTML."""
