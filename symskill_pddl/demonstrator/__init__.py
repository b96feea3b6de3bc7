"""What a person's hand does in any world: poses of a hand, strokes, grasps, taking along what turns or slides."""
