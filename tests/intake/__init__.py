"""Tests of the intake room; a package, because others have files of these names."""
