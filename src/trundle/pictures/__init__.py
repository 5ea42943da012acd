"""Drawing with Pillow: colours, text, cells and plans. It knows numbers and arrays, and no maps or robots."""
