"""A Recipe becomes a Scaffold (section 5.1)."""
