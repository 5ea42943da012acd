"""What a navigator makes of scans: its map with obstacles, what moves, and what it has not seen."""
