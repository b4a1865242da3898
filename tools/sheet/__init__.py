"""What tools/contact-sheet is made of: pictures in and out, and where they go on the sheet."""
