"""What is wrong with a program, told before or instead of running it. In the compile process."""
