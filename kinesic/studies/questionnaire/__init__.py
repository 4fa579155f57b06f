"""What the studies of perception share: a page that leads a participant through it, and files of answers."""
