//! Looks at what the engine believes of simulated noise.
