"""From demonstrations to a library: segments, references, predicates, operators, skills."""
