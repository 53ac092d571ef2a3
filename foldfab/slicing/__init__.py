"""The printer's own program as a witness: a print file goes in, what PrusaSlicer makes of it comes out."""
