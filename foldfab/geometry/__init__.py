"""Pure maths on arrays, without a word about furniture."""
